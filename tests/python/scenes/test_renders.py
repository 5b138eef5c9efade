"""Options, results and functions of renderers."""

import asyncio
import io
import sys
import threading
import typing

import numpy as np
import pytest

import claray
from claray import _native, _options, _records, _scene, _textures
from test_bad_input import refused


def members(native):
    return {name for name in dir(native) if not name.startswith("_") and not callable(getattr(native, name))}


def literal(of):
    return set(typing.get_args(of))


@pytest.fixture(scope="module")
def renderer():
    return claray.Renderer(claray.load("cornell"), width=24, height=16, spp=4)


def test_options_are_those_of_the_library():
    """python/src names all members of the structures of C++, so that a new one does not compile before it is bound."""
    for typed, native in ((claray.RenderOptions, _native.NativeRenderConfig()), (claray.BvhOptions, _native.NativeBvhConfig()),
                          (claray.LightGridOptions, _native.NativeLightGridConfig()),
                          (claray.LightMapOptions, _native.NativeLightMapConfig()),
                          (claray.LoadOptions, _native.NativeLoadOptions())):
        assert set(typed.__annotations__) == members(native), typed
        assert all(name in typed.__doc__ for name in typed.__annotations__), typed
    for record in (claray.Material, claray.Light, claray.Camera):
        assert set(record._properties()) == members(record._make()), record


def test_names_are_those_of_the_library():
    names = {**_native.names(), **_native.record_names()}
    for name, of in (("Sampler", _options.Sampler), ("Denoiser", _options.Denoiser), ("ToneMap", _options.ToneMap),
                     ("Layout", _options.Layout), ("NormalPacking", _options.NormalPacking), ("Builder", _options.Builder),
                     ("MaterialKind", _records.MaterialKind), ("LightKind", _records.LightKind),
                     ("Projection", _records.Projection), ("AlphaMode", _records.AlphaMode), ("AlphaTest", _records.AlphaTest),
                     ("MaterialRole", _records.MaterialRole), ("Stereo", _records.Stereo)):
        assert literal(of) == set(names[name]), name
    assert literal(_options.Approximation) == set(names["Approximation"].split(","))


def test_regions_have_the_bits_of_the_whole_image():
    scene = claray.load("cornell")
    whole = claray.render(scene, width=40, height=30, spp=4)
    part = claray.Renderer(scene, width=40, height=30, spp=4, region=(5, 7, 12, 9))
    assert (part.image() == whole[7:16, 5:17]).all() and part.aovs()["depth"].shape == (9, 12)
    refused("region", lambda: claray.Renderer(scene, width=40, height=30, region=(0, 0, 41, 1)), "not within")
    refused("region", lambda: claray.Renderer(scene, region=3))


def test_images_have_alpha():
    scene = claray.load("ball:500")
    renderer = claray.Renderer(scene, width=32, height=32, spp=4, alpha=True)
    alpha = renderer.alpha()
    assert alpha.shape == (32, 32) and alpha.min() == 0 and alpha.max() == 1
    assert (renderer.image()[alpha == 0] == 0).all()
    for material in scene.materials:
        material.role = "holdout"
    renderer.update(scene, materials=True)
    renderer.render()
    assert (renderer.alpha() == 0).all() and scene.materials[0].role == "holdout"
    assert (claray.Renderer(scene, width=8, height=8, spp=1).alpha() == 1).all()
    refused("role", lambda: setattr(scene.materials[0], "role", "ghost"), "holdout")


def test_results_are_those_of_the_library(renderer):
    progress = renderer.render()
    assert set(progress) == set(claray.RenderProgress.__annotations__)
    statistics = renderer.statistics()
    assert set(statistics) == set(claray.RenderStatistics.__annotations__)
    for key, typed in (("bvh", _options.TreeStatistics), ("camera", _options.RayCount)):
        assert set(statistics[key]) == set(typed.__annotations__)
    assert statistics["camera"]["rays"] >= 4 * 24 * 16 and "lambert" in statistics["effects"]
    assert statistics["bvh"]["triangles"] == 38 and renderer.device_bytes == statistics["device_bytes"] > 0


def test_options_change_the_image():
    scene = claray.load("cornell")
    size = {"width": 24, "height": 16, "spp": 2}
    plain = claray.render(scene, **size)
    for options in ({"sampler": "independent"}, {"seed": 1}, {"effects": "-emissive-triangles"}, {"max_depth": 1},
                    {"approximate": "no-shadows"}, {"approximate": ["flat", "no-shadows"]},
                    {"approximate": ["light-grid"], "light_grid": {"side": 4, "rays": 8, "updates": 1}}):
        assert not (claray.render(scene, **size, **options) == plain).all(), options
    for options in ({"bvh": {"builder": "fast", "layout": "binary", "learns": None}}, {"guide": False}, {"parts": 2},
                    {"compiler": ""}, {"approximate": []}, {"effects": "", "report_seconds": 1}):
        assert (claray.render(scene, **size, **options) == plain).all(), options
    adaptive = claray.Renderer(scene, width=64, height=64, spp=48, adaptive=True)
    adaptive.render()
    assert adaptive.statistics()["adapted"]


def test_wrong_options_are_named():
    scene = claray.load("cornell")
    make = lambda **options: lambda: claray.Renderer(scene, **options)
    refused("widht", make(widht=4), "unknown option of a render; did you mean 'width'?")
    refused("spp", make(spp=True), "a number")
    refused("spp", make(spp=-1))
    refused("adaptive", make(adaptive="yes"), "True or False")
    refused("adaptive", make(adaptive=1))
    refused("sampler", make(sampler="halton"), "independent")
    refused("approximate", make(approximate="fast"), "tile-sum")
    refused("approximate", make(approximate=3), "a list of names")
    refused("effects", make(effects="sky"), "neither")
    refused("checkpoint", make(checkpoint=3), "a path")
    refused("bvh", make(bvh="fast"), "a dict")
    refused("bvh.bulder", make(bvh={"bulder": "fast"}), "unknown option")
    refused("builder", make(bvh={"builder": "best"}), "balanced")
    refused("bvh.learns", make(bvh={"learns": "no"}))
    refused("light_grid.side", make(light_grid={"side": "x"}))
    refused("device", make(device=[]))
    refused("progress", lambda: claray.Renderer(scene, width=4, height=4, spp=1).render("bar"))


def test_a_picture_is_that_of_the_image(renderer):
    image = renderer.image()
    assert (renderer.picture() == image.to_bytes()).all()
    assert (renderer.picture(exposure=1, tone_map="none") == image.to_bytes(1, "none")).all()
    small = renderer.picture(width=6, height=4)
    assert small.shape == (4, 6, 3) and small.dtype == np.uint8
    assert abs(float(renderer.image(width=6, height=4).mean()) - float(image.mean())) < 0.1 * image.mean()
    assert renderer.picture(denoise=True).shape == (16, 24, 3)
    kept = np.empty((16, 24, 3), np.float32)
    assert np.shares_memory(renderer.image(out=kept), kept) and (kept == image).all()
    refused("tone_map", lambda: renderer.picture(tone_map="film"), "aces")
    refused("denoise", lambda: renderer.picture(denoise="oidn"))
    refused("denoise", lambda: renderer.image(denoise="best"), "oidn")
    refused("denoise", lambda: renderer.image(denoise=True, width=4))
    refused("width", lambda: renderer.image(width=-4))
    refused("out", lambda: renderer.image(out=kept[1:]))


def test_what_renderers_tell(renderer):
    renderer.render()
    buffer, aovs = renderer.gbuffer(), renderer.aovs()
    seen = aovs["primitive"] != claray.MISS
    assert buffer.pixels.dtype == claray.GBUFFER and buffer.pixels.shape == (16, 24)
    assert np.abs(buffer.normals - aovs["normal"])[seen].max() < 1e-3
    eye = np.array(claray.load("cornell").camera.position)
    distance = np.linalg.norm(buffer.positions - eye, axis=-1)
    assert np.allclose(distance[seen], aovs["depth"][seen], rtol=1e-3)
    assert buffer.world_from_image.shape == (4, 4) and buffer.world_from_image.dtype == np.float64
    noise = renderer.noise_map()
    assert noise.shape == (16, 24) and noise.max() > 0
    assert 0 <= renderer.cut_off() < 0.01 and renderer.error_of(renderer.image()) > 0
    assert isinstance(renderer.why_unguided(), str)
    assert 0 < renderer.error_map().max()
    refused("image", lambda: renderer.error_of(noise), "height, width, 3")
    with pytest.raises(claray.UsageError):
        renderer.voxels()
    grid = claray.Renderer(claray.load("cornell"), width=8, height=8, spp=1, approximate="light-grid", light_grid={"voxels": True, "side": 8})
    assert grid.voxels().shape == (8, 8, 3)


def test_approximations_tell_their_error():
    scene = claray.load("cornell")
    options = {"width": 64, "height": 64, "spp": 64}
    without = claray.Renderer(scene, **options, approximate="tile-sum")
    assert claray.approximation_error(without, claray.Renderer(scene, **options)) > 0.05
    refused("exact", lambda: claray.approximation_error(without, scene))


def test_renders_change_their_size_and_their_tree(renderer):
    scene = claray.load("cornell")
    changed = claray.Renderer(scene, width=9, height=7, spp=4)
    changed.render()
    changed.resize(24, 16)
    assert (changed.image() == renderer.image()).all()
    changed.settle()
    changed.load_kernels()
    assert changed.render(seconds=60)["spp"] == 4
    assert changed.rebuild(builder="fast") and (changed.image() == renderer.image()).all()
    changed.restart(0, spp=2, max_depth=3)
    assert changed.render()["spp"] == 2
    refused("bvh.builders", lambda: changed.rebuild(builders="fast"))


def test_checkpoints_are_resumed(tmp_path, renderer):
    scene, size = claray.load("cornell"), {"width": 24, "height": 16}
    file = tmp_path / "checkpoint"
    first = claray.Renderer(scene, **size, spp=2, checkpoint=file, checkpoint_seconds=1)
    first.render()
    assert file.exists() and first.checkpoint_error == ""
    assert (claray.render(scene, **size, spp=4, resume=str(file)) == renderer.image()).all()
    with pytest.raises(claray.UsageError, match="checkpoint"):
        first.update(scene, everything=True)
    with pytest.raises(claray.InputError):
        claray.Renderer(scene, **size, spp=4, seed=3, resume=file)


def test_several_devices_give_the_image_of_one(renderer):
    device = claray.default_device()
    group = claray.Renderer(claray.load("cornell"), width=24, height=16, spp=4, device=[device, claray.Device(device.info["index"])])
    seen = []
    assert group.render(lambda progress: seen.append(progress["spp"]))["spp"] == 4
    assert (group.image() == renderer.image()).all() and seen
    assert len(group.shares) == 2 and sum(share["samples"] for share in group.shares) >= 4 * 24 * 16
    assert renderer.shares == [] and len(group.devices) == 2
    refused("restart", lambda: group.restart(1), "several devices")
    other = claray.load("cornell")
    other.materials[0].albedo = 0, 0, 0
    group.update(other, everything=True)
    assert not (group.image() == renderer.image()).all()


def test_a_bar_or_a_line_shows_progress(renderer, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    renderer.restart(0)
    assert renderer.render(True)["spp"] == 4
    assert "4 of 4 samples per pixel" in capsys.readouterr().err
    refused("progress", lambda: renderer.render("tqdm"), "not installed")

    class Bar:
        def __init__(self, **_):
            self.n, self.total, shown[:] = 0, None, [self]

        def set_postfix(self, **_): ...
        def update(self, step):
            self.n += step

        def close(self):
            self.closed = True

    shown = []
    monkeypatch.setitem(sys.modules, "tqdm.auto", type(sys)("tqdm.auto"))
    sys.modules["tqdm.auto"].tqdm = Bar
    renderer.restart(0)
    renderer.render("tqdm")
    assert (shown[0].n, shown[0].total, shown[0].closed) == (4, 4, True)


def test_renders_are_awaited(renderer):
    many = claray.Renderer(claray.load("cornell"), width=24, height=16, spp=1 << 20, report_seconds=0.01)
    threads = set()

    async def run():
        task = asyncio.create_task(many.render_async(lambda progress: threads.add(threading.get_ident())))
        while not threads:
            await asyncio.sleep(0.01)
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task
        kept = many.image()
        assert kept.mean() > 0 and many.render(lambda progress: False)["spp"] < 1 << 20
        reached = await many.render_async(lambda progress: False)
        assert 0 < reached["spp"] < 1 << 20
        with pytest.raises(ZeroDivisionError):
            await many.render_async(lambda progress: 1 / 0)
        renderer.restart(0)
        return await renderer.render_async()

    assert asyncio.run(run())["spp"] == 4
    assert threads == {threading.get_ident()}


def test_images_are_saved_with_layers(tmp_path, renderer):
    image, aovs = renderer.image(), renderer.aovs()
    image.save(tmp_path / "all.exr", layers=aovs)
    data = (tmp_path / "all.exr").read_bytes()
    for channel in (b"depth.Z\0", b"normal.X\0", b"albedo.R\0", b"primitive.X\0", b"\0R\0"):
        assert channel in data
    again = claray.Texture.load(tmp_path / "all.exr")
    assert (again.pixels[..., :3] == image).all()
    for ending in ("hdr", "pfm", "png"):
        image.save(tmp_path / f"a.{ending}")
        assert (tmp_path / f"a.{ending}").stat().st_size > 100
    refused("layers", lambda: image.save(tmp_path / "a.png", layers=aovs), "exr")
    with pytest.raises(claray.UsageError, match=r"layers\['depth'\]"):
        image.save(tmp_path / "b.exr", layers={"depth": aovs["depth"][1:]})


def test_layers_tell_surfaces(renderer):
    aovs = renderer.aovs()
    seen = aovs["primitive"] != claray.MISS
    assert aovs["uv"].shape == (*seen.shape, 2) and aovs["motion"].dtype == np.float32 and not aovs["motion"].any()
    assert aovs["object"].dtype == np.uint32 and (aovs["object"] != claray.MISS)[seen].all()
    assert aovs["position"].shape == (*seen.shape, 3) and np.isfinite(aovs["position"]).all()


def test_cryptomattes_are_masks_and_layers(tmp_path):
    scene = claray.Scene()
    red, blue = scene.add_material(albedo=(1, 0, 0), name="red"), scene.add_material(albedo=(0, 0, 1), name="blue")
    square = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], np.float32)
    for material, x in ((red, -1), (blue, 1)):
        scene.add_mesh(square + (x, 0, 0), [(0, 1, 2), (0, 2, 3)], material=material)
    scene.camera = claray.Camera(position=(0, 0, 6), target=(0, 0, 0))
    renderer = claray.Renderer(scene, width=33, height=24, spp=1)
    matte = renderer.cryptomatte("material", samples=32)
    assert matte.name == "crypto_material" and set(matte.manifest) == {"red", "blue"}
    both = matte.mask("red", "blue")
    np.testing.assert_allclose(both, matte.coverage.sum(axis=-1), atol=1e-6)
    assert both.max() == 1 and both.min() == 0
    assert matte.mask("red")[12, 8] == 1 and matte.mask("red")[12, 24] == 0
    assert 0 < matte.mask("red")[12, 16] < 1, "the middle column shows both"
    refused("names", lambda: matte.mask("green"), "red")
    refused("kind", lambda: renderer.cryptomatte("light"))
    path = tmp_path / "matte.exr"
    renderer.image().save(path, layers={"matte": matte, "uv": renderer.aovs()["uv"]})
    data = path.read_bytes()
    for text in (b"crypto_material00.R\0", b"uv.U\0", b"cryptomatte/bda530a/manifest\0", b'"red":'):
        assert text in data


def test_light_is_split_into_layers():
    scene = claray.load("cornell")
    lamp = next(f"material:{i}" for i, one in enumerate(scene.materials) if max(one.emission) > 0)
    options = {"width": 24, "height": 16, "spp": 16}
    renderer = claray.Renderer(scene, **options, lobes=True, light_groups={"lamp": [lamp]})
    image, layers = renderer.image(), renderer.light_layers()
    assert (image == claray.Renderer(scene, **options).image()).all()
    lobes = sum(pixels.astype(np.float64) for name, pixels in layers.items() if name.startswith("lobe_"))
    np.testing.assert_allclose(lobes, image, rtol=1e-6, atol=1e-9)
    assert layers["lobe_diffuse_indirect"].mean() > 0 and abs(layers["lobe_rest"]).max() < 1e-5
    refused("light_groups", lambda: claray.Renderer(scene, **options, light_groups=["lamp"]))
    with pytest.raises(claray.UsageError, match="there is no light 'moon'"):
        claray.Renderer(scene, **options, light_groups={"key": ["moon"]})
    with pytest.raises(claray.UsageError, match="keeps no layers"):
        claray.Renderer(scene, **options).light_layers()


def test_images_are_compared_and_coloured(renderer):
    image = renderer.image()
    assert claray.image_error(image, image) == (0, 0, 0)
    assert claray.image_error(image * 2, image).rmse > 0.5
    aovs = renderer.aovs()
    assert claray.false_color(aovs["depth"]).tone_map == "none" and len(np.unique(claray.identifier_color(aovs["material"]), axis=0)) > 1
    refused("reference", lambda: claray.image_error(image, image[1:]))
    refused("values", lambda: claray.false_color(image))


def test_light_is_baked():
    """The floor of a white furnace receives pi W / m^2."""
    scene = claray.Scene()
    scene.sky = 1, 1, 1
    scene.add_material(albedo=(0.5, 0.5, 0.5))
    floor = scene.add_mesh([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]], [[0, 2, 1], [0, 3, 2]],
                           uvs1=[[0, 0], [1, 0], [1, 1], [0, 1]])
    seen = []
    light = claray.bake_light_map(scene, floor, width=8, height=8, spp=16, progress=seen.append)
    assert light.pixels.shape == (8, 8, 3) and np.allclose(light.pixels, np.pi, rtol=1e-3) and seen[-1] == 1
    scene.use_light_map(floor, light)
    assert scene.materials[-1].light_map == (0, 1, (0, 0), (1, 1), 0)
    scene.sky = 0, 0, 0
    scene.camera = claray.Camera(position=(0, 2, 0), target=(0, 0, 0), up=(0, 0, 1))
    assert np.allclose(claray.render(scene, width=3, height=3, spp=1)[1, 1], 0.5, rtol=1e-2)
    with pytest.raises(ZeroDivisionError):
        claray.bake_light_map(scene, floor, width=8, height=8, progress=lambda done: 1 / 0)
    refused("uv_sets", lambda: claray.bake_light_map(scene, floor, uv_sets=1))


def test_probes_hold_the_light_around():
    scene = claray.Scene()
    scene.sky = (0.25, 0.5, 1), (0.25, 0.5, 1)
    scene.add_mesh([[-1, -9, 0], [1, -9, 0], [0, -9, 1]], [[0, 1, 2]])
    scene.add_material()
    probe = claray.render_probe(scene, (0, 0, 0), height=4, width=4, spp=1)
    assert len(probe.images) == 6 and probe.images[0].pixels.shape[:2] == (4, 4)
    panorama = probe.panorama()
    assert panorama.pixels.dtype == np.float32 and np.allclose(panorama.pixels[0, 0, :3], (0.25, 0.5, 1), rtol=1e-3)


def test_effects_are_explained():
    scene = claray.load("cornell")
    effects = scene.effects()
    assert "lambert" in effects and "emissive-triangles" in effects and effects["lambert"]
    assert "emissive-triangles" not in scene.without_effects("emissive-triangles").effects()
    said = []
    explained = claray.explain(scene, only=["lambert", "emissive-triangles", "no-shadows"], rounds=1, width=16, height=16, progress=said.append)
    assert {row["effect"] for row in explained["effects"]} == {"lambert", "emissive-triangles"} and said
    row = next(row for row in explained["effects"] if row["effect"] == "emissive-triangles")
    assert row["used"] and row["measured"] and row["ratio"] > 0 and explained["own"]["milliseconds"] > 0
    assert [row["approximation"] for row in explained["approximations"]] == ["no-shadows"] and explained["approximations"][0]["error"] > 0
    refused("rounds", lambda: claray.explain(scene, rounds=0))
    with pytest.raises(claray.UsageError, match="gloss"):
        claray.explain(scene, only="gloss")
