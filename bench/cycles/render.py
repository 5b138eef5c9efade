# Renders what bench_cycles wrote into a folder, with Blender's Cycles on CPUs:
#   blender -b --factory-startup --debug-cycles --verbose 2 --python render.py -- FOLDER SEED IMAGE.pfm
# Prints "processor seconds S" of the rendering alone; Cycles' own report has the same by the clock.
import array
import json
import os
import sys
import tempfile
import time

import bpy
import mathutils


def read(path, kind):
    values = array.array(kind)
    with open(path, "rb") as file:
        values.frombytes(file.read())
    return values


def add_mesh(folder):
    positions, corners = read(folder + "/positions.f32", "f"), read(folder + "/corners.u32", "i")
    triangles = len(corners) // 3
    mesh = bpy.data.meshes.new("mesh")
    mesh.vertices.add(len(positions) // 3)
    mesh.vertices.foreach_set("co", positions)
    mesh.loops.add(len(corners))
    mesh.loops.foreach_set("vertex_index", corners)
    mesh.polygons.add(triangles)
    mesh.polygons.foreach_set("loop_start", array.array("i", range(0, 3 * triangles, 3)))
    mesh.polygons.foreach_set("loop_total", array.array("i", [3]) * triangles)
    mesh.update()
    mesh.materials.append(diffuse_material)
    bpy.context.collection.objects.link(bpy.data.objects.new("mesh", mesh))


def make_diffuse(albedo):
    material = bpy.data.materials.new("grey")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    bsdf, output = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeOutputMaterial")
    bsdf.inputs["Color"].default_value = (albedo, albedo, albedo, 1)
    bsdf.inputs["Roughness"].default_value = 0
    material.node_tree.links.new(bsdf.outputs["BSDF"], output.inputs["Surface"])
    return material


def add_camera(view):
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit = "VERTICAL"
    camera.angle = view["fov"]
    thing = bpy.data.objects.new("camera", camera)
    thing.matrix_world = mathutils.Matrix(view["camera_to_world"])
    camera.clip_start, camera.clip_end = 1e-4 * view["extent"], 1e4 * view["extent"]
    bpy.context.collection.objects.link(thing)
    bpy.context.scene.camera = thing


def add_light(view):
    light = bpy.data.lights.new("light", "POINT")
    light.energy, light.shadow_soft_size = view["light_watts"], 0
    thing = bpy.data.objects.new("light", light)
    thing.location = view["light"]
    bpy.context.collection.objects.link(thing)


def add_sky(radiance):
    world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    background = world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (radiance, radiance, radiance, 1)
    background.inputs["Strength"].default_value = 1
    bpy.context.scene.world = world


def configure(view, seed):
    scene = bpy.context.scene
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y, render.resolution_percentage = view["width"], view["height"], 100
    render.threads_mode, render.threads = "FIXED", view["threads"]
    render.use_persistent_data = True
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.image_settings.exr_codec = "NONE"
    cycles.device, cycles.seed = "CPU", seed
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type = "BOX"
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.light_sampling_threshold = 0
    cycles.max_bounces = cycles.diffuse_bounces = view["bounces"]
    cycles.glossy_bounces = cycles.transmission_bounces = cycles.volume_bounces = 0


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


folder, seed, image_path = sys.argv[sys.argv.index("--") + 1:]
with open(folder + "/view.json") as file:
    view = json.load(file)
bpy.ops.wm.read_factory_settings(use_empty=True)
diffuse_material = make_diffuse(view["albedo"])
add_mesh(folder)
add_camera(view)
add_light(view)
add_sky(view["sky"])
configure(view, int(seed))

scene = bpy.context.scene
scene.cycles.samples = 1
bpy.ops.render.render()  # builds what the second one, which counts, then has in memory
scene.cycles.samples = view["spp"]
with tempfile.TemporaryDirectory() as temporary:
    scene.render.filepath = os.path.join(temporary, "image.exr")
    begin = time.process_time()
    bpy.ops.render.render(write_still=True)
    print("processor seconds", time.process_time() - begin)
    write_pfm(image_path, scene.render.filepath)
