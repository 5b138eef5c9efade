"""Renders with Blender's Cycles what efficiency.py wrote, once a seed:

    blender -b --factory-startup --python cycles.py -- FOLDER
    python3 -P cycles.py -- FOLDER                     (PyPI's bpy; -P: its add-on has the name of this file)

Reads FOLDER/view.json and the arrays that it names; writes FOLDER/0.pfm and so on, the lowest row first. Prints "seconds P C" for each
picture, of all processors and by the clock: those of sampling, without what a picture of one sample takes.
"""
import array
import json
import os
import sys
import time

import bpy
import mathutils

# Ours to Blender's, whose z is up; the middle of an image of the sky is at +x there, at -z here.
AXES = mathutils.Matrix(((0, 0, -1, 0), (-1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 0, 1)))


def read(name, kind):
    values = array.array(kind)
    with open(os.path.join(folder, name), "rb") as file:
        values.frombytes(file.read())
    return values


def turned(name):
    """Vectors in Blender's axes."""
    values = read(name, "f")
    result = array.array("f", bytes(4 * len(values)))
    result[0::3], result[1::3], result[2::3] = array.array("f", [-z for z in values[2::3]]), array.array("f", [-x for x in values[0::3]]), values[1::3]
    return result


def node_tree(owner, kind, values, output):
    """Replaces the nodes of a material or a world by one node, connected to the output."""
    owner.use_nodes = True
    nodes = owner.node_tree.nodes
    nodes.clear()
    node, end = nodes.new(kind), nodes.new(output)
    for name, value in values.items():
        node.inputs[name].default_value = value
    owner.node_tree.links.new(node.outputs[0], end.inputs["Surface"])
    return node


def material_of(kind, values):
    material = bpy.data.materials.new(kind)
    node, inputs = {"diffuse": lambda: ("ShaderNodeBsdfDiffuse", {"Color": (*values, 1), "Roughness": 0}),
                    "lamp": lambda: ("ShaderNodeEmission", {"Color": (*values, 1), "Strength": 1}),
                    "glass": lambda: ("ShaderNodeBsdfGlass", {"Color": (1, 1, 1, 1), "IOR": values, "Roughness": 0})}[kind]()
    made = node_tree(material, node, inputs, "ShaderNodeOutputMaterial")
    if kind == "glass" and "SHARP" in made.bl_rna.properties["distribution"].enum_items:  # since Blender 4 the roughness of 0 says so
        made.distribution = "SHARP"
    return material


def add_part(part):
    positions, corners = turned(part["positions"]), read(part["triangles"], "i")
    triangles = len(corners) // 3
    mesh = bpy.data.meshes.new("mesh")
    mesh.vertices.add(len(positions) // 3)
    mesh.vertices.foreach_set("co", positions)
    mesh.loops.add(len(corners))
    mesh.loops.foreach_set("vertex_index", corners)
    mesh.polygons.add(triangles)
    mesh.polygons.foreach_set("loop_start", array.array("i", range(0, 3 * triangles, 3)))
    mesh.polygons.foreach_set("loop_total", array.array("i", [3]) * triangles)
    if part["normals"]:
        mesh.polygons.foreach_set("use_smooth", array.array("b", [1]) * triangles)
    mesh.update()
    if part["normals"]:
        normals = turned(part["normals"])
        if hasattr(mesh, "use_auto_smooth"):  # before Blender 4.1
            mesh.use_auto_smooth = True
        mesh.normals_split_custom_set_from_vertices(list(zip(normals[0::3], normals[1::3], normals[2::3])))
    mesh.materials.append(material_of(part["kind"], part["values"]))
    bpy.context.collection.objects.link(bpy.data.objects.new("mesh", mesh))


def import_gltf(file):
    """Blender's importer has +x where ours is, and lights in W/m^2 as we do if it converts nothing."""
    bpy.ops.import_scene.gltf(filepath=os.path.join(folder, file), export_import_convert_lighting_mode="RAW")
    turn = AXES @ mathutils.Matrix(((1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0), (0, 0, 0, 1))).inverted()
    for thing in bpy.context.scene.objects:
        if thing.parent is None:
            thing.matrix_world = turn @ thing.matrix_world


def add_camera():
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit = "VERTICAL"
    camera.angle = view["fov"]
    thing = bpy.data.objects.new("camera", camera)
    thing.matrix_world = AXES @ mathutils.Matrix(view["camera_to_world"])
    camera.clip_start, camera.clip_end = 1e-3, 1e4
    bpy.context.collection.objects.link(thing)
    bpy.context.scene.camera = thing


def add_sky():
    world = bpy.data.worlds.new("sky")
    node = node_tree(world, "ShaderNodeBackground", {"Color": (*view["sky"], 1), "Strength": 1}, "ShaderNodeOutputWorld")
    bpy.context.scene.world = world
    if "environment" in view:
        width, height = view["environment"]
        image = bpy.data.images.new("environment", width, height, float_buffer=True)
        image.colorspace_settings.name = "Non-Color"
        image.pixels.foreach_set(read("environment.f32", "f"))
        image.filepath_raw, image.file_format = os.path.join(folder, "environment.exr"), "OPEN_EXR"
        image.save()
        texture = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
        texture.image = bpy.data.images.load(image.filepath_raw)
        texture.image.colorspace_settings.name = "Non-Color"
        world.node_tree.links.new(texture.outputs["Color"], node.inputs["Color"])


def configure():
    """Cycles' own sampler and roulette; nothing that biases the picture, or spreads samples unevenly."""
    scene = bpy.context.scene
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y, render.resolution_percentage = view["size"], view["size"], 100
    render.threads_mode, render.threads = "FIXED", view["threads"]
    render.use_persistent_data = True
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.image_settings.exr_codec = "NONE"
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type = "BOX"
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.light_sampling_threshold = cycles.blur_glossy = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = view["bounces"]


def write_pfm(path, exr):
    image = bpy.data.images.load(exr)
    image.colorspace_settings.name = "Non-Color"
    rgba = array.array("f", bytes(4 * len(image.pixels)))
    image.pixels.foreach_get(rgba)
    rgb = array.array("f", bytes(3 * len(rgba)))
    for channel in range(3):
        rgb[channel::3] = rgba[channel::4]
    with open(path, "wb") as file:
        file.write(b"PF\n%d %d\n-1.0\n" % tuple(image.size))
        file.write(rgb.tobytes())


def render(seed, samples, name):
    """Seconds of all processors, and by the clock."""
    scene = bpy.context.scene
    scene.cycles.seed, scene.cycles.samples = seed, samples
    scene.render.filepath = os.path.join(folder, name + ".exr")
    begin = time.process_time(), time.perf_counter()
    bpy.ops.render.render(write_still=True)
    seconds = time.process_time() - begin[0], time.perf_counter() - begin[1]
    write_pfm(os.path.join(folder, name + ".pfm"), scene.render.filepath)
    return seconds


folder = sys.argv[sys.argv.index("--") + 1]
with open(folder + "/view.json") as file:
    view = json.load(file)
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.preferences.addon_enable(module="cycles")  # PyPI's bpy begins without it
for part in view["parts"]:
    add_part(part)
if "gltf" in view:
    import_gltf(view["gltf"])
add_camera()
add_sky()
configure()
render(0, 1, "first")  # builds what the others have in memory
for seed in range(view["seeds"]):
    start, whole = render(seed + 1, 1, "first"), render(seed + 1, view["spp"], str(seed))
    print("seconds", *((b - a) * view["spp"] / (view["spp"] - 1) for a, b in zip(start, whole)), flush=True)
