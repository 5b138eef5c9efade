"""Blender without a window, by PyPI's bpy: the add-on, small scenes, and pictures of both engines. bench/renderers/blender.py uses it, too."""

import atexit
import contextlib
import importlib.util
import math
import os
import pathlib
import sys
import tempfile

import bpy
import numpy as np

ADDON = pathlib.Path(__file__).resolve().parents[2] / "tools/blender/claray"
BOUNCES = 12
LAMPS = {
    "point": ("POINT", dict(energy=100, shadow_soft_size=0)),
    "ball": ("POINT", dict(energy=100, shadow_soft_size=0.3)),
    "warm point": ("POINT", dict(energy=100, shadow_soft_size=0, use_temperature=True, temperature=3200)),
    "exposed point": ("POINT", dict(energy=100, shadow_soft_size=0, exposure=1.5, color=(1, 0.5, 0.25))),
    "spot": ("SPOT", dict(energy=100, shadow_soft_size=0, spot_size=math.radians(40), spot_blend=0.15)),
    "soft spot": ("SPOT", dict(energy=100, shadow_soft_size=0, spot_size=math.radians(50), spot_blend=1)),
    "sun": ("SUN", dict(energy=2, angle=0)),
    "wide sun": ("SUN", dict(energy=2, angle=0.5)),
    "square": ("AREA", dict(energy=100, size=1)),
    "rectangle": ("AREA", dict(energy=100, shape="RECTANGLE", size=1.5, size_y=0.5)),
    "disc": ("AREA", dict(energy=100, shape="DISK", size=1)),
    "ellipse": ("AREA", dict(energy=100, shape="ELLIPSE", size=1.5, size_y=0.5)),
}


def load_addon():
    """Registers the add-on, which is no package of an installed Blender here, and returns its module."""
    if "claray_addon" not in sys.modules:
        spec = importlib.util.spec_from_file_location("claray_addon", ADDON / "__init__.py", submodule_search_locations=[str(ADDON)])
        sys.modules["claray_addon"] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(sys.modules["claray_addon"])
        sys.modules["claray_addon"].register()
        atexit.register(sys.modules["claray_addon"].unregister)  # as Blender does with its add-ons; bpy 4.5 does not end without it
    return sys.modules["claray_addon"]


def prepare(scene, width=64, height=48):
    """Cycles without what biases or spreads samples unevenly; a linear EXR."""
    bpy.ops.preferences.addon_enable(module="cycles")  # which bpy begins without
    render, cycles = scene.render, scene.cycles
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.image_settings.exr_codec = "NONE"
    scene.view_settings.view_transform = "Standard"
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type = "BOX"
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.light_sampling_threshold = cycles.blur_glossy = 0
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = BOUNCES
    cycles.transparent_max_bounces = BOUNCES
    scene.claray.max_depth = BOUNCES + 1  # Cycles counts surfaces after the first


def empty_scene(width=64, height=48):
    """A scene with a camera 4 units above the origin, which looks down."""
    load_addon()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    prepare(scene, width, height)
    add_camera(scene, (0, 0, 4), (0, 0, 0))
    return scene


def default_scene(width=64, height=48):
    """Blender's own: a cube, a light, a camera."""
    load_addon()
    bpy.ops.wm.read_factory_settings()
    prepare(bpy.context.scene, width, height)
    return bpy.context.scene


def link(scene, name, data):
    thing = bpy.data.objects.new(name, data)
    scene.collection.objects.link(thing)
    return thing


def aim(thing, place, target):
    """Turns -z of an object to a point."""
    import mathutils
    thing.location = place
    thing.rotation_euler = (mathutils.Vector(target) - mathutils.Vector(place)).to_track_quat("-Z", "Y").to_euler()


def add_camera(scene, place, target):
    camera = link(scene, "camera", bpy.data.cameras.new("camera"))
    if place[:2] == target[:2]:
        camera.location = place
    else:
        aim(camera, place, target)
    scene.camera = camera
    return camera


def add_light(scene, kind, place=(0, 0, 3), target=None, **values):
    light = bpy.data.lights.new("lamp", kind)
    for name, value in values.items():
        setattr(light, name, value)
    thing = link(scene, "lamp", light)
    thing.location = place
    if target is not None:
        aim(thing, place, target)
    return thing


def set_world(scene, color=(0, 0, 0), strength=1.0):
    scene.world = bpy.data.worlds.new("world")
    tree = tree_of(scene.world)
    background = tree.nodes["Background"]
    background.inputs["Color"].default_value, background.inputs["Strength"].default_value = (*color, 1), strength
    return tree, background


def set_world_image(scene):
    """A world of an image with one bright quarter; returns its tree and the node of the image."""
    texels = np.full((16, 32, 4), 0.1, np.float32)
    texels[2:9, 20:28, :3] = 1, 0.6, 0.2
    tree, background = set_world(scene)
    node = tree.nodes.new("ShaderNodeTexEnvironment")
    node.image = add_image(texels, encoded=False)
    tree.links.new(node.outputs["Color"], background.inputs["Color"])
    return tree, node


def tree_of(owner):
    if not owner.use_nodes:
        owner.use_nodes = True
    return owner.node_tree


def material(kind, name="material", **values):
    """A material of one shader node. Returns it, its tree and the node."""
    made = bpy.data.materials.new(name)
    tree = tree_of(made)
    tree.nodes.clear()
    node, output = tree.nodes.new(kind), tree.nodes.new("ShaderNodeOutputMaterial")
    for key, value in values.items():
        node.inputs[key.replace("_", " ")].default_value = value
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return made, tree, node


def diffuse(color, name="diffuse"):
    return material("ShaderNodeBsdfDiffuse", name, Color=(*color, 1))[0]


def emission(color, strength=1.0, name="emission"):
    return material("ShaderNodeEmission", name, Color=(*color, 1), Strength=strength)[0]


def add_mesh(scene, points, faces, given, name="mesh", uvs=None):
    """uvs: one for each corner."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points, [], faces)
    if uvs is not None:
        mesh.uv_layers.new(name="UVMap").uv.foreach_set("vector", np.asarray(uvs, np.float32).ravel())
    if given is not None:
        mesh.materials.append(given)
    return link(scene, name, mesh)


def add_plane(scene, given, side=2.0, z=0.0, name="plane"):
    half = side / 2
    return add_mesh(scene, [(-half, -half, z), (half, -half, z), (half, half, z), (-half, half, z)], [(0, 1, 2, 3)], given, name,
                    [(0, 0), (1, 0), (1, 1), (0, 1)])


def add_box(scene, low, high, given, name="box"):
    points = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return add_mesh(scene, points, faces, given, name)


def add_image(texels, name="image", encoded=True):
    """texels: (H, W, 4) 0 to 1, rows from the top. encoded: whether they are in sRGB."""
    texels = np.asarray(texels, np.float32)
    image = bpy.data.images.new(name, texels.shape[1], texels.shape[0], alpha=True, is_data=not encoded)
    image.pixels.foreach_set(np.ascontiguousarray(texels[::-1]).ravel())
    image.pack()
    return image


def below_lamp(scene, name):
    """A plane below one of LAMPS, which is behind the camera: Cycles does not show lamps to it."""
    kind, values = LAMPS[name]
    add_plane(scene, diffuse((0.8, 0.6, 0.4)), 6)
    add_light(scene, kind, (0.5, -0.7, 4.5), (0, 0, 0), **values)
    if kind == "SPOT":  # the profiles of soft edges differ, their powers do not: all of the cone is in view
        scene.camera.location.z = 9


def below_image(scene, turn=0.0):
    """A ball in a world of an image, which a Mapping node turns about z."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4, radius=1)
    bpy.context.object.data.materials.append(diffuse((0.8, 0.8, 0.8)))
    tree, node = set_world_image(scene)
    if turn:
        mapping, coordinates = tree.nodes.new("ShaderNodeMapping"), tree.nodes.new("ShaderNodeTexCoord")
        mapping.inputs["Rotation"].default_value = (0, 0, turn)
        tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
        tree.links.new(mapping.outputs["Vector"], node.inputs["Vector"])


def interior(scene):
    """A room of diffuse walls with a window to a blue sky, a lamp at the ceiling, a table, and boxes on it."""
    white, red, green, wood = (diffuse(c, n) for c, n in (((0.75,) * 3, "white"), ((0.6, 0.1, 0.08), "red"), ((0.12, 0.5, 0.15), "green"),
                                                          ((0.4, 0.25, 0.12), "wood")))
    add_box(scene, (-3, -2, -0.1), (3, 4, 0), white, "floor")
    add_box(scene, (-3, -2, 2.6), (3, 4, 2.7), white, "ceiling")
    add_box(scene, (-3.1, -2, 0), (-3, 4, 2.6), red, "left")
    add_box(scene, (-3, 4, 0), (3, 4.1, 2.6), white, "back")
    for name, low, high in (("sill", (3, -2, 0), (3.1, 4, 0.9)), ("lintel", (3, -2, 2.1), (3.1, 4, 2.6)),
                            ("before", (3, -2, 0.9), (3.1, 0.5, 2.1)), ("behind", (3, 2.5, 0.9), (3.1, 4, 2.1))):
        add_box(scene, low, high, green, name)
    add_box(scene, (-1, 1, 0.7), (1, 2.2, 0.76), wood, "top")
    for x in (-0.95, 0.87):
        for y in (1.05, 2.07):
            add_box(scene, (x, y, 0), (x + 0.08, y + 0.08, 0.7), wood, "leg")
    add_box(scene, (-0.5, 1.4, 0.76), (-0.1, 1.8, 1.2), red, "tall")
    add_box(scene, (0.2, 1.5, 0.76), (0.6, 1.9, 1.0), white, "low")
    add_light(scene, "AREA", (0, 0, 2.55), energy=60, size=0.8)  # above what the camera sees
    set_world(scene, (0.35, 0.5, 0.9), 2.0)
    camera = scene.camera
    aim(camera, (-0.6, -1.9, 1.5), (0.1, 1.6, 0.9))
    camera.data.lens = 22


def instances(scene, count=1000, subdivisions=3):
    """Copies of one rounded mesh in a grid, on a floor, under a sun."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=subdivisions, radius=0.4)
    first = bpy.context.object
    first.data.materials.append(diffuse((0.6, 0.35, 0.2), "clay"))
    side = math.ceil(count ** (1 / 3))
    for i in range(count):
        x, y, z = i % side, i // side % side, i // side ** 2
        thing = first if i == 0 else link(scene, f"ball{i}", first.data)
        thing.location, thing.scale = (x - side / 2, y - side / 2, z + 0.5), (0.6 + 0.4 * ((7 * i) % 11) / 11,) * 3
    add_plane(scene, diffuse((0.5, 0.5, 0.55), "floor"), 40)
    add_light(scene, "SUN", (0, 0, 10), (3, 2, 0), energy=3, angle=0.05)
    set_world(scene, (0.4, 0.5, 0.7), 0.5)
    aim(scene.camera, (14, -16, 12), (0, 0, 4))


@contextlib.contextmanager
def quiet():
    """Blender's own lines go nowhere."""
    sys.stdout.flush()
    kept, nothing = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 1)
    try:
        yield
    finally:
        sys.stdout.flush()
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nothing)


def picture(scene, engine, samples, frame=None):
    """What F12 gives: (H, W, 4) float32, linear, rows from the top."""
    scene.render.engine = engine
    scene.claray.samples = scene.cycles.samples = samples
    if frame is not None:
        scene.frame_set(frame)
    with tempfile.TemporaryDirectory() as folder, quiet():
        scene.render.filepath = os.path.join(folder, "picture.exr")
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath, check_existing=False)
        pixels = np.empty(len(image.pixels), np.float32)
        image.pixels.foreach_get(pixels)
        pixels = pixels.reshape(image.size[1], image.size[0], -1)[::-1]
        bpy.data.images.remove(image)
    return pixels


def both(scene, samples=16, samples_of_cycles=None):
    """The colours by claray and by Cycles."""
    return picture(scene, "CLARAY", samples)[..., :3], picture(scene, "CYCLES", samples_of_cycles or samples)[..., :3]


def lines(scene):
    """What claray does not support in the scene, after a render."""
    return sys.modules["claray_addon"].ui.reports.kept(scene)
