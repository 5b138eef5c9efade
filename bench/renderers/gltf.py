"""Writes scenes as glTF. A scene has `parts`, tuples of a mesh (meshes.py) and a material, and may have a light."""
import base64
import io
import json

import numpy as np
from PIL import Image


def vertex_colors(positions):
    return np.clip(0.5 + 0.5 * np.sin(5 * positions + [0, 1, 2]), 0, 1).astype(np.float32)


def png(pixels):
    out = io.BytesIO()
    Image.fromarray(pixels).save(out, "PNG")
    return out.getvalue()


class Gltf:
    """A glTF file that holds everything."""

    def __init__(self, scene):
        self.data, self.extensions = b"", set()
        self.root = dict(asset=dict(version="2.0"), scene=0, scenes=[dict(nodes=[])], nodes=[], meshes=[], materials=[], textures=[],
                         images=[], samplers=[dict(magFilter=9729, minFilter=9729), dict(magFilter=9728, minFilter=9728)], accessors=[],
                         bufferViews=[])
        for shape, material in scene["parts"]:
            self.add_part(shape, material)
        if "light" in scene:
            self.add_light(scene["light"])

    def accessor(self, values, kind, component):
        self.root["bufferViews"].append(dict(buffer=0, byteOffset=len(self.data), byteLength=values.nbytes))
        entry = dict(bufferView=len(self.root["bufferViews"]) - 1, componentType=component, count=len(values), type=kind)
        if kind == "VEC3":
            entry.update(min=values.min(0).tolist(), max=values.max(0).tolist())
        if kind == "SCALAR":
            entry["count"] = values.size
        self.data += values.tobytes()
        self.root["accessors"].append(entry)
        return len(self.root["accessors"]) - 1

    def texture(self, pixels, sampler=0):
        uri = "data:image/png;base64," + base64.b64encode(png(pixels)).decode()
        self.root["images"].append(dict(uri=uri))
        self.root["textures"].append(dict(source=len(self.root["images"]) - 1, sampler=sampler))
        return dict(index=len(self.root["textures"]) - 1)

    def material(self, m):
        pbr = dict(baseColorFactor=[1, 1, 1, 1], metallicFactor=0, roughnessFactor=1)
        entry = dict(pbrMetallicRoughness=pbr, doubleSided=True, extensions={})
        if m["kind"] == "diffuse":
            pbr["baseColorFactor"] = list(m["color"]) + [1]
            entry["extensions"]["KHR_materials_specular"] = dict(specularFactor=0)
        if m["kind"] == "gltf":
            pbr.update(baseColorFactor=list(m["color"]) + [1], metallicFactor=m["metallic"], roughnessFactor=m["roughness"])
        if m["kind"] == "mirror":
            pbr.update(metallicFactor=1, roughnessFactor=0)
        if m["kind"] == "glass":
            pbr["roughnessFactor"] = 0
            entry["doubleSided"] = False
            entry["extensions"].update(KHR_materials_transmission=dict(transmissionFactor=1), KHR_materials_ior=dict(ior=1.5),
                                       KHR_materials_volume=dict(thicknessFactor=1))
        if m["kind"] == "lamp":
            pbr["baseColorFactor"] = [0, 0, 0, 1]
            entry["doubleSided"] = False
            strength = max(m["color"])
            entry["emissiveFactor"] = [c / strength for c in m["color"]]
            entry["extensions"].update(KHR_materials_emissive_strength=dict(emissiveStrength=strength),
                                       KHR_materials_specular=dict(specularFactor=0))
        if "texture" in m:
            pbr["baseColorTexture"] = self.texture(m["texture"])
        if "mask" in m:
            pbr["baseColorTexture"] = self.texture(np.dstack([np.full(m["mask"].shape + (3,), 255, np.uint8), m["mask"]]), 1)
            entry.update(alphaMode="MASK", alphaCutoff=0.5)
        if "normals" in m:
            entry["normalTexture"] = self.texture(m["normals"])
        if "transform" in m:
            x, y, turn, sx, sy = m["transform"]
            pbr["baseColorTexture"]["extensions"] = dict(KHR_texture_transform=dict(offset=[x, y], rotation=turn, scale=[sx, sy]))
            self.extensions.add("KHR_texture_transform")
        self.extensions.update(entry["extensions"])
        self.root["materials"].append(entry)
        return len(self.root["materials"]) - 1

    def add_part(self, shape, m):
        positions, normals, uvs, triangles = shape
        attributes = dict(POSITION=self.accessor(positions, "VEC3", 5126), NORMAL=self.accessor(normals, "VEC3", 5126),
                          TEXCOORD_0=self.accessor(uvs, "VEC2", 5126))
        if m.get("vertex_colors"):
            attributes["COLOR_0"] = self.accessor(vertex_colors(positions), "VEC3", 5126)
        primitive = dict(attributes=attributes, indices=self.accessor(triangles.reshape(-1), "SCALAR", 5125), material=self.material(m))
        self.root["meshes"].append(dict(primitives=[primitive]))
        self.add_node(dict(mesh=len(self.root["meshes"]) - 1, scale=list(m.get("scale", (1, 1, 1)))))

    def add_node(self, node):
        self.root["nodes"].append(node)
        self.root["scenes"][0]["nodes"].append(len(self.root["nodes"]) - 1)

    def add_light(self, light):
        strength = max(light["color"])
        entry = dict(type=light["kind"], color=[c / strength for c in light["color"]], intensity=strength)
        if light["kind"] == "spot":
            angle = np.radians(light["angle"])
            entry["spot"] = dict(innerConeAngle=angle - 1e-3, outerConeAngle=angle)
        to = np.array(light.get("direction", light.get("target", (0, 0, 0))), float) - np.array(light.get("position", (0, 0, 0)), float)
        self.root["extensions"] = dict(KHR_lights_punctual=dict(lights=[entry]))
        self.extensions.add("KHR_lights_punctual")
        self.add_node(dict(translation=list(light.get("position", (0, 0, 0))), rotation=rotation_from_minus_z(to),
                           extensions=dict(KHR_lights_punctual=dict(light=0))))

    def write(self, path):
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        self.root["buffers"] = [dict(uri=uri, byteLength=len(self.data))]
        self.root["extensionsUsed"] = sorted(self.extensions)
        with open(path, "w") as file:
            json.dump({key: value for key, value in self.root.items() if value not in ([], {})}, file)


def rotation_from_minus_z(to):
    to = to / np.linalg.norm(to)
    q = np.append(np.cross((0, 0, -1), to), 1 + np.dot((0, 0, -1), to))
    return (q / np.linalg.norm(q)).tolist()
