"""Scenes whose parts are changed in place, and objects that refuse what would have no effect."""

import copy
import pickle
import re
from pathlib import Path

import numpy as np
import pytest

import claray
from test_bad_input import refused


def test_materials_of_a_scene_outlive_changes_of_the_list():
    scene = claray.load("cornell")
    red = scene.materials[0]
    name = "a name that is longer than what a string keeps in place"
    red.name, red.albedo = name, (0.9, 0.25, 0.125)
    for _ in range(100):
        scene.add_material(albedo=(0.5, 0.5, 0.5))
    assert red.name == name and scene.materials[0].name == name and red.albedo[1] == 0.25
    red.roughness = 0.75
    assert scene.materials[0].roughness == 0.75
    lights = claray.Scene()
    lights.add_light(claray.Light("sun", name=name))
    lamp = lights.lights[0]
    for _ in range(100):
        lights.add_light()
    assert lamp.name == name and lamp.kind == "sun"
    kept = claray.load("cornell").materials[1]  # which keeps its scene
    assert kept.kind == "lambert"


def test_elements_that_are_gone_are_refused():
    scene = claray.load("cornell")
    last = scene.materials[-1]
    scene.materials = scene.materials[:1]
    refused("material", lambda: last.name, "any more")
    refused("material", lambda: setattr(last, "name", "x"), "any more")
    assert len(scene.materials) == 1
    with pytest.raises(IndexError, match="^material: has 1, not a number 1$"):
        scene.materials[1]


def test_lists_of_a_scene_are_lists():
    scene = claray.Scene()
    scene.materials.append(claray.Material(name="a"))
    scene.materials += [claray.Material("mirror", name="b"), claray.Material(name="c")]
    scene.materials.insert(0, claray.Material(name="first"))
    names = lambda: [m.name for m in scene.materials]
    assert names() == ["first", "a", "b", "c"] and len(scene.materials) == 4
    scene.materials[1] = scene.materials[-1]
    del scene.materials[0]
    assert names() == ["c", "b", "c"] and scene.materials.pop().name == "c"
    scene.materials = reversed(list(scene.materials))
    assert names() == ["b", "c"] and scene.materials[0].kind == "mirror"
    scene.materials.reverse()
    assert names() == ["c", "b"]
    scene.materials.remove(scene.materials[1])
    assert names() == ["c"] and scene.materials[0] in scene.materials and claray.Material() not in scene.materials
    scene.materials[:] = []
    assert names() == []
    scene.lights.extend([claray.Light(), claray.Light("spot")])
    assert [light.kind for light in scene.lights] == ["point", "spot"]
    refused("material", lambda: scene.materials.append("red"), "str")
    refused("material", lambda: scene.materials.append(claray.Light()), "Light")
    refused("materials", lambda: setattr(scene, "materials", "red"))
    refused("lights", lambda: setattr(scene, "lights", ["lamp"]))
    refused("material", lambda: scene.add_material("red"))
    refused("material", lambda: scene.add_material(claray.Material(), albedo=(1, 1, 1)), "albedo")
    assert len(scene.materials) == 0 and len(scene.lights) == 2


def test_cameras_are_changed_in_place():
    scene = claray.load("cornell")
    scene.camera.position = (9, 8, 7)
    assert scene.camera.position == (9, 8, 7)
    own = claray.Camera(position=(1, 2, 3))
    scene.camera = own
    own.position = (4, 5, 6)
    assert scene.camera.position == (1, 2, 3)  # a copy was set
    empty = claray.Scene()
    empty.add_mesh(np.eye(3), [[0, 1, 2]])
    seen = empty.camera.target
    empty.camera.vertical_fov = 20
    assert empty.camera.vertical_fov == 20 and empty.camera.target == seen
    assert claray.render(scene, width=4, height=4, spp=1).shape == (4, 4, 3)


def test_what_has_no_effect_is_refused():
    scene = claray.load("cornell")
    bvh = claray.Bvh(scene)
    objects = [scene, bvh, claray.Material(), claray.Light(), claray.Camera(), scene.camera, scene.materials[0], bvh.device,
               claray.Query(bvh), claray.Primitives.spheres([[0, 0, 0]], 1), claray.InstancedBvh(bvh, np.eye(4)[None]),
               claray.Filter("static inline bool accept_hit() {}"), claray.Renderer(scene, width=4, height=4, spp=1)]
    for one in objects:
        for name in ("enviroment", "bulder", "positon"):
            with pytest.raises(AttributeError, match=rf"claray\.{type(one).__name__}\.{name}: there is no such property"):
                setattr(one, name, "x")
        assert not hasattr(one, "enviroment")
    for one, name in ((scene, "triangle_count"), (scene, "primitives"), (bvh, "device"), (bvh, "is_closed")):
        with pytest.raises(AttributeError):
            setattr(one, name, 1)
    with pytest.raises(TypeError):
        scene.meshes[0]["vertices"] = np.zeros((3, 3))
    with pytest.raises(TypeError):
        scene.instances["transforms"] = np.zeros((1, 3, 4))
    for array in (scene.meshes[0]["vertices"], scene.instances["transforms"], scene.bounds):
        with pytest.raises(ValueError):
            array[...] = 0


def test_wrong_types_are_refused():
    scene, material = claray.load("cornell"), claray.Material()
    for one in (material, scene.materials[0]):
        refused("albedo", lambda: setattr(one, "albedo", "red"))
        refused("albedo", lambda: setattr(one, "albedo", (1, 2)))
        refused("roughness", lambda: setattr(one, "roughness", "0.5"))
        refused("roughness", lambda: setattr(one, "roughness", None))
        refused("name", lambda: setattr(one, "name", 5))
        refused("thin_walled", lambda: setattr(one, "thin_walled", "no"))
        refused("kind", lambda: setattr(one, "kind", "wood"), "mirror")
    refused("position", lambda: setattr(scene.camera, "position", "here"))
    refused("position", lambda: setattr(scene.camera, "position", 5))
    refused("camera", lambda: setattr(scene, "camera", (0, 0, 1)))
    refused("camera", lambda: setattr(scene, "camera", claray.Light()))
    refused("sky", lambda: setattr(scene, "sky", "blue"))
    refused("sky", lambda: setattr(scene, "sky", (1, 1)))
    refused("sky", lambda: setattr(scene, "sky", ((1, 1, 1), (1, 1))))
    refused("fog", lambda: setattr(scene, "fog", 0.1))
    refused("fog", lambda: setattr(scene, "fog", (0.1, 1, 0)))
    refused("name", lambda: setattr(scene, "name", 7))
    refused("intensity", lambda: claray.Light(intensity=5))
    refused("material", lambda: scene.add_mesh(np.eye(3), [[0, 1, 2]], material=-1))
    refused("material", lambda: scene.add_mesh(np.eye(3), [[0, 1, 2]], material="red"))
    refused("mask", lambda: scene.add_mesh(np.eye(3), [[0, 1, 2]], mask=2**32))
    refused("name", lambda: scene.add_mesh(np.eye(3), [[0, 1, 2]], name=3))
    refused("spp", lambda: claray.Renderer(scene, spp="64"))
    refused("scene", lambda: claray.Renderer(scene, width=4, height=4, spp=1).update("cornell"))
    scene.sky = [0.5, 0.25, 1]
    assert scene.sky == ((0.5, 0.25, 1), (0.5, 0.25, 1))


def test_options_of_wrong_types_are_refused(soup, rays):
    vertices, triangles, bvh = soup
    refused("closed", lambda: claray.any_hit(bvh, *rays, closed="no"), "True or False")
    refused("cull_back_faces", lambda: claray.Query(bvh, cull_back_faces=2))
    refused("brute_force", lambda: claray.Query(bvh, brute_force=None))
    refused("closed", lambda: claray.count_hits(bvh, *rays, closed="yes"))
    refused("learns", lambda: claray.Bvh(vertices, triangles, learns="never"))
    refused("builder", lambda: claray.Bvh(vertices, triangles, builder=3))
    refused("builder", lambda: claray.Primitives.spheres([[0, 0, 0]], 1, builder=None))
    refused("split_budget", lambda: claray.Bvh(vertices, triangles, split_budget="0.5"))
    refused("layout", lambda: claray.Bvh(vertices, triangles, layout=1))
    refused("coherence", lambda: claray.any_hit(bvh, *rays, coherence=[]))
    refused("capped", lambda: claray.Primitives.cylinders([[0, 0, 0]], [[0, 0, 1]], 1, capped="no"))
    image = claray.Image((2, 2, 3))
    image.exposure = 1.0
    with pytest.raises(AttributeError):
        image.exposur = 1.0
    assert claray.any_hit(bvh, *rays, closed=np.True_).shape == (777,) and image[:1].exposure == 1.0


def test_views_of_meshes_outlive_more_meshes():
    scene = claray.Scene()
    corners = np.arange(9, dtype=np.float32).reshape(3, 3)
    scene.add_mesh(corners, [[0, 1, 2]])
    view = scene.meshes[0]["vertices"]
    for _ in range(200):
        scene.add_mesh(np.eye(3), [[0, 1, 2]])
    assert (view == corners).all()
    del scene
    assert (view == corners).all()


def test_devices_are_named_everywhere(tmp_path, soup):
    vertices, triangles, bvh = soup
    index, name = bvh.device.info["index"], bvh.device.name
    scene = claray.load("cornell")
    for given in (bvh.device.type, index, np.int64(index), name, str(index), bvh.device, None):
        made = claray.Bvh(vertices, triangles, device=given)
        assert made.device.context_ptr == bvh.device.context_ptr
    given = bvh.device.type
    bvh.save(tmp_path / "soup.cbvh")
    assert claray.Bvh.load(tmp_path / "soup.cbvh", given).device.context_ptr == bvh.device.context_ptr
    assert claray.InstancedBvh.of_scene(scene, device=given).device.context_ptr == bvh.device.context_ptr
    assert claray.Primitives.spheres([[0, 0, 0]], 1, device=index).device.context_ptr == bvh.device.context_ptr
    assert claray.Renderer(scene, width=4, height=4, spp=1, device=index).image().shape == (4, 4, 3)
    assert claray.Device(given).info["index"] == index
    refused("device", lambda: claray.Bvh(vertices, triangles, device=1.5), "claray.Device")
    refused("device", lambda: claray.Bvh(vertices, triangles, device=True))
    refused("device", lambda: claray.Bvh(vertices, triangles, device=-1))
    refused("device", lambda: claray.Renderer(scene, device=object()))
    refused("selector", lambda: claray.Device(None))
    refused("queue", lambda: claray.Query(bvh, queue="cpu"), "with_new_queue")
    for wrong in ("abacus", 99):
        with pytest.raises(claray.UsageError, match=f"no device matches '{wrong}'"):
            claray.Bvh(vertices, triangles, device=wrong)


def test_the_default_builder_is_automatic(soup):
    vertices, triangles, _ = soup
    hashes = {name: claray.Bvh(vertices, triangles, builder=name).hash() for name in ("automatic", "fast", "balanced", "high")}
    assert claray.Bvh(vertices, triangles).hash() == hashes["automatic"] != hashes["fast"]
    assert hashes["automatic"] in (hashes["balanced"], hashes["high"])
    refused("builder", lambda: claray.Bvh(vertices, triangles, builder="auto"), "automatic")


def test_pickling_says_what_to_do_instead(soup):
    bvh, scene = soup[2], claray.load("cornell")
    hints = [(bvh, "save"), (bvh.device, "index or name"), (claray.Query(bvh), "each process"),
             (claray.Primitives.spheres([[0, 0, 0]], 1), "each process"), (claray.InstancedBvh(bvh, np.eye(4)[None]), "each process"),
             (claray.Renderer(scene, width=4, height=4, spp=1), "image")]
    for one, hint in hints:
        for way in (pickle.dumps, copy.copy, copy.deepcopy):
            with pytest.raises(TypeError, match=f"claray.{type(one).__name__} can.*{hint}"):
                way(one)


def test_copies_are_copies(soup, rays):
    """Of what is plain data: by copy(), deepcopy() and pickle alike."""
    for twin_of in (copy.copy, copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one))):
        scene = claray.load("cornell")
        twin = twin_of(scene)
        twin.materials[0].name = "other"
        assert scene.materials[0].name != "other" and twin.triangle_count == scene.triangle_count
        for record in (scene.materials[0], scene.camera, claray.Light("sun", intensity=(3, 2, 1)), claray.Material("glass", albedo_map=3)):
            twin, values = twin_of(record), repr(record)
            assert type(twin) is type(record) and repr(twin) == values and twin != record
            setattr(twin, *(("name", "other") if hasattr(twin, "name") else ("target", (9, 9, 9))))
            assert repr(record) == values
        image = claray.render(scene, width=4, height=4, spp=1)
        image.exposure, image.tone_map = 2, "none"
        twin = twin_of(image)
        assert isinstance(twin, claray.Image) and (twin == image).all() and not np.shares_memory(twin, image)
        assert (twin.exposure, twin.tone_map) == (2, "none")
        lists = claray.all_hits(soup[2], *rays)
        assert (twin_of(lists).elements == lists.elements).all()
        odd = twin_of(claray.Filter("static inline bool accept_hit(global const float* data, float3 origin, float3 direction, "
                                    "const Hit* hit) { return hit->primitive % 2 == (uint)data[0]; }", [1], name="odd"))
        odd_hits = claray.all_hits(soup[2], *rays, filter=odd).elements["primitive"]
        assert odd.name == "odd" and len(odd_hits) > 9 and (odd_hits % 2 == 1).all()
        texture = claray.Texture(np.arange(12, dtype=np.uint8).reshape(2, 2, 3), "linear", ("clamp", "mirror"), "nearest", "dots")
        for one in (texture, claray.Environment([texture] * 6, 2, 1), claray.Environment(texture)):
            assert repr(twin_of(one)) == repr(one)
        assert (twin_of(texture).pixels == texture.pixels).all() and twin_of(texture).wrap == ("clamp", "mirror")


def test_versions_and_descriptions(soup):
    of_cmake = (Path(__file__).parents[2] / "CMakeLists.txt").read_text(encoding="utf-8")
    assert claray.__version__ == re.search(r"project\(claray VERSION (\S+)", of_cmake)[1]
    bvh, scene = soup[2], claray.load("cornell")
    red = claray.Material("metal", name="red", albedo=(0.9, 0.1, 0.1))
    assert repr(red) == "claray.Material(kind='metal', name='red', albedo=(0.9, 0.1, 0.1))"
    assert repr(eval(repr(red))) == repr(red)
    assert repr(claray.Light("sun", intensity=(3, 3, 3))) == "claray.Light(kind='sun', intensity=(3, 3, 3))"
    assert repr(claray.Camera(vertical_fov=20)) == "claray.Camera(vertical_fov=20)"
    scene.camera.aperture_radius = 0.125
    assert "aperture_radius=0.125" in repr(scene.camera) and "Material(" in repr(scene.materials)
    query = claray.Query(bvh, "any")
    assert "any hit in a Bvh" in repr(query)
    for one in (bvh, query, bvh.device, scene, claray.Renderer(scene, width=4, height=3, spp=1)):
        assert type(one).__name__ in repr(one) and " object at " not in repr(one)
