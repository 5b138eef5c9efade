// What Blender does with a .blend for claray: a script for its Python, which claray does not import.
#pragma once

namespace claray {

/// Arguments: the .blend, and a .glb that is to be written. Beside it is written a .json of what glTF lacks, as
/// python/claray/usd.py writes it. In an interpreter without bpy it ends with 77.
inline constexpr const char* blend_script = R"py(
import json, math, os, sys
try:
    import bpy
except ImportError:
    sys.exit(77)
import mathutils
import numpy as np

source, target = sys.argv[-2:]
try:
    bpy.ops.wm.open_mainfile(filepath=source, load_ui=False, use_scripts=False)
except RuntimeError as error:
    sys.stderr.write(str(error).strip() + "\n")
    sys.exit(1)
try:
    bpy.ops.preferences.addon_enable(module="io_scene_gltf2")
except RuntimeError:
    pass
scene = bpy.context.scene
extra = {"sky": None, "environment": None, "suns": [], "warnings": []}


def factor(light):
    color = mathutils.Color(light.color[:]) * 2.0 ** getattr(light, "exposure", 0.0)
    if getattr(light, "use_temperature", False):
        color = mathutils.Color([a * b for a, b in zip(color, light.temperature_color)])
    return color


def outline(light):
    x = light.size / 2
    y = (light.size_y if light.shape in ("RECTANGLE", "ELLIPSE") else light.size) / 2
    if light.shape in ("SQUARE", "RECTANGLE"):
        return [(-x, y, 0), (x, y, 0), (x, -y, 0), (-x, -y, 0)]
    return [(x * math.cos(a), -y * math.sin(a), 0) for a in (i * math.pi / 24 for i in range(48))]


def lamp_of(thing):
    """An area light as a one-sided mesh that emits P / (pi A); the exporter knows none."""
    light = thing.data
    mesh = bpy.data.meshes.new(thing.name)
    points = outline(light)
    mesh.from_pydata(points, [], [tuple(range(len(points)))])
    placed = [thing.matrix_world @ mathutils.Vector(point) for point in points]
    area = sum((((placed[i] - placed[0]).cross(placed[i + 1] - placed[0])).length for i in range(1, len(placed) - 1))) / 2
    color = factor(light) * (light.energy / (math.pi * (area if getattr(light, "normalize", True) else 1) or 1))
    material = bpy.data.materials.new(thing.name)
    material.use_nodes = True
    material.use_backface_culling = True
    node = next(n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")
    strength = max(*color, 1e-9)
    node.inputs["Base Color"].default_value = (0, 0, 0, 1)
    node.inputs["Specular IOR Level"].default_value = 0
    node.inputs["Emission Color"].default_value = (*(c / strength for c in color), 1)
    node.inputs["Emission Strength"].default_value = strength
    mesh.materials.append(material)
    made = bpy.data.objects.new(thing.name, mesh)
    made.matrix_world = thing.matrix_world
    scene.collection.objects.link(made)


def add_sun(thing):
    axis = thing.matrix_world.to_3x3() @ mathutils.Vector((0, 0, -1))
    axis.normalize()
    extra["suns"].append({"direction": [axis.x, axis.z, -axis.y], "irradiance": list(factor(thing.data) * thing.data.energy),
                          "angle": min(thing.data.angle / 2, math.pi / 2)})


def read_world(world):
    if world is None:
        return
    node = next((n for n in world.node_tree.nodes if n.bl_idname == "ShaderNodeBackground"), None) if world.node_tree else None
    if node is None:
        extra["sky"] = list(world.color)
        return
    strength, socket = node.inputs["Strength"].default_value, node.inputs["Color"]
    if not socket.is_linked:
        extra["sky"] = [c * strength for c in socket.default_value[:3]]
        return
    image = getattr(socket.links[0].from_node, "image", None)
    if image is None or 0 in image.size:
        extra["warnings"].append("the world's nodes are left out; only a colour and an Environment Texture are read")
        return
    values = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(values)
    values = values.reshape(-1, image.channels)
    texels = np.ones((len(values), 4), np.float32)
    texels[:, :3] = values[:, :3] if image.channels > 2 else values[:, :1]
    if not image.is_float and image.colorspace_settings.name == "sRGB":  # IEC 61966-2-1
        texels[:, :3] = np.where(texels[:, :3] <= 0.04045, texels[:, :3] / 12.92, ((texels[:, :3] + 0.055) / 1.055) ** 2.4)
    file = os.path.join(os.path.dirname(target), "environment.exr")
    copy = bpy.data.images.new("environment", *image.size, float_buffer=True)
    copy.colorspace_settings.name = "Non-Color"  # which are saved as they are
    copy.pixels.foreach_set(texels.ravel())
    copy.filepath_raw, copy.file_format = file, "OPEN_EXR"
    copy.save()
    turn = 0.0
    vector = socket.links[0].from_node.inputs["Vector"]
    if vector.is_linked and vector.links[0].from_node.bl_idname == "ShaderNodeMapping":
        turn = vector.links[0].from_node.inputs["Rotation"].default_value[2]
    extra["environment"] = {"file": file, "strength": strength, "rotation": -math.pi / 2 - turn}


# Shaders that the exporter does not know, as the Principled BSDF has them: sockets that move, and values.
MATTE = {"Roughness": 1.0, "Specular IOR Level": 0.0}
SHADERS = {
    "ShaderNodeBsdfDiffuse": ({"Color": "Base Color", "Normal": "Normal"}, MATTE),
    "ShaderNodeBsdfTranslucent": ({"Color": "Base Color", "Normal": "Normal"}, MATTE),
    "ShaderNodeSubsurfaceScattering": ({"Color": "Base Color", "Normal": "Normal"}, MATTE),
    "ShaderNodeBsdfAnisotropic": ({"Color": "Base Color", "Roughness": "Roughness", "Normal": "Normal"}, {"Metallic": 1.0}),
    "ShaderNodeBsdfGlass": ({"Color": "Base Color", "Roughness": "Roughness", "IOR": "IOR", "Normal": "Normal"}, {"Transmission Weight": 1.0}),
    "ShaderNodeBsdfRefraction": ({"Color": "Base Color", "Roughness": "Roughness", "IOR": "IOR", "Normal": "Normal"}, {"Transmission Weight": 1.0}),
    "ShaderNodeEmission": ({"Color": "Emission Color", "Strength": "Emission Strength"}, {"Base Color": (0, 0, 0, 1), **MATTE}),
}


def as_principled(material):
    tree = material.node_tree
    output = tree.get_output_node("ALL") if tree else None
    if output is None or not output.inputs["Surface"].is_linked:
        return
    node = output.inputs["Surface"].links[0].from_node
    if node.bl_idname == "ShaderNodeBsdfPrincipled":
        return
    if node.bl_idname not in SHADERS:
        extra["warnings"].append(f"material '{material.name}': the shader '{node.bl_label}' is read as Blender's exporter of glTF reads it")
        return
    sockets, values = SHADERS[node.bl_idname]
    made = tree.nodes.new("ShaderNodeBsdfPrincipled")
    for name, value in values.items():
        made.inputs[name].default_value = value
    for old, new in sockets.items():
        if old != "Normal":
            made.inputs[new].default_value = node.inputs[old].default_value
        if node.inputs[old].is_linked:
            tree.links.new(node.inputs[old].links[0].from_socket, made.inputs[new])
    tree.links.new(made.outputs[0], output.inputs["Surface"])


for material in bpy.data.materials:
    as_principled(material)
for thing in [t for t in scene.objects if t.type == "LIGHT" and not t.hide_render]:
    if thing.data.type == "AREA":
        lamp_of(thing)
    if thing.data.type == "SUN" and thing.data.angle > 2e-4:
        add_sun(thing)
        thing.data.energy = 0
    elif thing.data.type in ("POINT", "SPOT") and thing.data.shadow_soft_size > 0:
        extra["warnings"].append("point lights and spots have no radius, so that their shadows are sharp")
for thing in scene.objects:
    if thing.type in ("VOLUME", "CURVES", "POINTCLOUD", "GREASEPENCIL"):
        extra["warnings"].append(f"'{thing.name}' is of the type {thing.type.lower()}, which is left out")
read_world(scene.world)
for light in [l for l in bpy.data.lights if l.type == "SUN" and l.energy == 0]:
    bpy.data.lights.remove(light)
options = dict(filepath=target, export_format="GLB", export_apply=True, export_cameras=True, export_lights=True, export_extras=False,
               export_animations=True, export_yup=True, use_renderable=True, export_gpu_instances=False,
               export_import_convert_lighting_mode="COMPAT")
known = bpy.ops.export_scene.gltf.get_rna_type().properties.keys()
bpy.ops.export_scene.gltf(**{name: value for name, value in options.items() if name in known})
extra["warnings"] = sorted(set(extra["warnings"]))
with open(os.path.splitext(target)[0] + ".json", "w", encoding="utf-8") as file:
    json.dump(extra, file)
)py";

}  // namespace claray
