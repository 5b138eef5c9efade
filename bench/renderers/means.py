"""Renders scenes whose models coincide with claray and with Mitsuba 3, and compares the means of the pictures.

    pip install mitsuba numpy pillow
    python3 bench/renderers/means.py build/bin/claray [NAME...]

Each scene is written as glTF or as OBJ and MTL, which claray reads, and handed to Mitsuba as its own shapes and BSDFs.
Prints a row a scene: the means of the three channels, their ratios, and the noise of each ratio. Exits with 1 where a
mean differs by more than 1 %.
"""
import base64
import io
import json
import os
import subprocess
import sys
import tempfile

import mitsuba as mi
import numpy as np
from PIL import Image

from scenes import read_pfm

mi.set_variant("scalar_rgb")

WIDTH, HEIGHT, SPP = 96, 72, 1024
EYE, TARGET, FOV, SKY = (0.3, 1.7, 4.0), (0.0, 0.5, 0.0), 42, (0.4, 0.5, 0.6)
BAR = 0.01


# ---- shapes: (positions, normals, uvs, triangles)

def quad(center, u, v):
    center, u, v = (np.array(x, np.float32) for x in (center, u, v))
    n = np.cross(u, v)
    corners = np.array([center - u - v, center + u - v, center + u + v, center - u + v], np.float32)
    uvs = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], np.float32)  # v downwards, as in glTF
    return corners, np.tile(n / np.linalg.norm(n), (4, 1)).astype(np.float32), uvs, np.array([[0, 1, 2], [0, 2, 3]], np.uint32)


def ball(center, radius, rows=48):
    theta, phi = np.meshgrid(np.linspace(0, np.pi, rows + 1), np.linspace(0, 2 * np.pi, 2 * rows + 1), indexing="ij")
    n = np.stack([np.sin(theta) * np.sin(phi), np.cos(theta), np.sin(theta) * np.cos(phi)], -1).reshape(-1, 3)
    uvs = np.stack([phi / (2 * np.pi), theta / np.pi], -1).reshape(-1, 2)
    a = (np.arange(rows)[:, None] * (2 * rows + 1) + np.arange(2 * rows)[None]).reshape(-1)
    b = a + 2 * rows + 1
    triangles = np.concatenate([np.stack([a, b, b + 1], -1), np.stack([a, b + 1, a + 1], -1)])
    p = np.array(center) + radius * n
    area = np.linalg.norm(np.cross(p[triangles[:, 1]] - p[triangles[:, 0]], p[triangles[:, 2]] - p[triangles[:, 0]]), axis=1)
    return p.astype(np.float32), n.astype(np.float32), uvs.astype(np.float32), triangles[area > 1e-9].astype(np.uint32)


FLOOR = quad((0, 0, 0), (3, 0, 0), (0, 0, -3))
LAMP = quad((-1.2, 2.2, 0.5), (0.4, 0, 0), (0, 0, 0.4))  # faces down
BALL = ball((0, 0.6, 0), 0.6)
rng = np.random.default_rng(7)
TEXTURE = rng.integers(0, 256, (16, 16, 3), np.uint8)
MASK = np.kron(rng.integers(0, 2, (8, 8), np.uint8) * 255, np.ones((4, 4), np.uint8))


def waves(side=64):
    """A normal map with slopes of up to 25 degrees."""
    v, u = np.meshgrid((np.arange(side) + 0.5) / side, (np.arange(side) + 0.5) / side, indexing="ij")
    n = np.stack([0.4 * np.sin(2 * np.pi * 3 * u), 0.3 * np.sin(2 * np.pi * 2 * v), np.ones_like(u)], -1)
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    return np.round(127.5 * (n + 1)).astype(np.uint8)


# ---- scenes: parts with a shape, a material and what it is in Mitsuba

def diffuse(color=(0.6, 0.5, 0.4), **more):
    return dict(kind="diffuse", color=color, **more)


SCENES = {
    "diffuse": dict(parts=[(FLOOR, diffuse()), (BALL, diffuse((0.3, 0.5, 0.8)))]),
    "texture": dict(parts=[(FLOOR, diffuse((1, 1, 1), texture=TEXTURE)), (BALL, diffuse((0.9, 0.9, 0.9), texture=TEXTURE))]),
    "texture-transform": dict(parts=[(FLOOR, diffuse((1, 1, 1), texture=TEXTURE, transform=(0.2, 0.1, 0.4, 3, 2))), (BALL, diffuse())]),
    "vertex-colors": dict(parts=[(FLOOR, diffuse()), (BALL, diffuse((0.9, 0.9, 0.9), vertex_colors=True))], gltf_only=True),
    "normal-map": dict(parts=[(FLOOR, diffuse(normals=waves())), (BALL, diffuse())], gltf_only=True,
                       light=dict(kind="directional", direction=(-0.8, -0.5, -0.3), color=(2, 2, 2))),
    "cut-out": dict(parts=[(FLOOR, diffuse()), (quad((0, 0.8, 0), (0.9, 0, 0), (0, 0.7, 0.2)), diffuse(mask=MASK))]),
    "mirror": dict(parts=[(FLOOR, diffuse((1, 1, 1), texture=TEXTURE)), (BALL, dict(kind="mirror"))]),
    "glass": dict(parts=[(FLOOR, diffuse((1, 1, 1), texture=TEXTURE)), (BALL, dict(kind="glass"))]),
    "lamp": dict(parts=[(FLOOR, diffuse()), (BALL, diffuse()), (LAMP, dict(kind="lamp", color=(12, 9, 6)))], sky=(0, 0, 0)),
    "point": dict(parts=[(FLOOR, diffuse()), (BALL, diffuse())], sky=(0, 0, 0), gltf_only=True,
                  light=dict(kind="point", position=(1, 2, 1), color=(8, 6, 4))),
    "directional": dict(parts=[(FLOOR, diffuse()), (BALL, diffuse())], sky=(0, 0, 0), gltf_only=True,
                        light=dict(kind="directional", direction=(-0.5, -1, -0.4), color=(3, 2, 1))),
    "spot": dict(parts=[(FLOOR, diffuse()), (BALL, diffuse())], sky=(0, 0, 0), gltf_only=True,
                 light=dict(kind="spot", position=(1, 2, 1), color=(30, 20, 10), angle=25)),
    "mirrored-instance": dict(parts=[(FLOOR, diffuse()), (quad((0.6, 0.7, 0), (0.5, 0, 0.2), (0, 0.6, 0)),
                                                          diffuse((1, 1, 1), texture=TEXTURE, scale=(-1, 1, 1)))], gltf_only=True),
}


def vertex_colors(positions):
    return np.clip(0.5 + 0.5 * np.sin(5 * positions + [0, 1, 2]), 0, 1).astype(np.float32)


# ---- for claray

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
        to = np.array(light.get("direction", TARGET), float) - np.array(light.get("position", (0, 0, 0)), float)
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


def write_obj(scene, folder):
    obj, mtl, first = ["mtllib scene.mtl"], [], 1
    for number, (shape, m) in enumerate(scene["parts"]):
        positions, normals, uvs, triangles = shape
        uvs = uvs_of(shape, m) * [1, -1] + [0, 1]  # v upwards in OBJ
        obj += ["v %r %r %r" % tuple(map(float, p)) for p in positions] + ["vn %r %r %r" % tuple(map(float, n)) for n in normals]
        obj += ["vt %r %r" % tuple(map(float, t)) for t in uvs] + ["usemtl m%d" % number]
        obj += ["f " + " ".join("%d/%d/%d" % (i, i, i) for i in map(int, t + first)) for t in triangles]
        first += len(positions)
        mtl += ["newmtl m%d" % number, "Kd %r %r %r" % tuple(m["color"] if m["kind"] == "diffuse" else (0, 0, 0)), "illum 1"]
        if m["kind"] == "lamp":
            mtl += ["Ke %r %r %r" % m["color"]]
        if m["kind"] == "mirror":
            mtl += ["Ks 1 1 1", "illum 3"]
        if m["kind"] == "glass":
            mtl += ["Ni 1.5", "Tf 1 1 1", "illum 7"]
        for key, name in (("texture", "map_Kd"), ("mask", "map_d")):
            if key in m:
                Image.fromarray(m[key]).save("%s/%s%d.png" % (folder, key, number))
                mtl += ["%s %s%d.png" % (name, key, number)]
    for name, lines in (("scene.obj", obj), ("scene.mtl", mtl)):
        with open(folder + "/" + name, "w") as file:
            file.write("\n".join(lines) + "\n")


def by_claray(claray, path, scene, seed):
    image = os.path.dirname(path) + "/claray.pfm"
    sky = scene.get("sky", SKY)
    command = [claray, "render", path, "-o", image, "-q", "--size", "%dx%d" % (WIDTH, HEIGHT), "--spp", str(SPP), "--seed", str(seed),
               "--camera=%g,%g,%g" % EYE, "--look-at=%g,%g,%g" % TARGET, "--fov", str(FOV)]
    if max(sky) > 0:
        command += ["--sky=%g,%g,%g" % sky]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return read_pfm(image)


# ---- for Mitsuba

def uvs_of(shape, m):
    """Texture coordinates after the transform of KHR_texture_transform: v downwards."""
    if "transform" not in m:
        return shape[2]
    x, y, turn, sx, sy = m["transform"]
    c, s = np.cos(turn), np.sin(turn)
    return shape[2] * [sx, sy] @ np.array([[c, s], [-s, c]]).T + [x, y]


def bitmap(pixels, raw, nearest=False):
    return dict(type="bitmap", bitmap=mi.Bitmap(np.ascontiguousarray(pixels[..., None] if pixels.ndim == 2 else pixels)), raw=raw,
                filter_type="nearest" if nearest else "bilinear")


def bsdf_of(m):
    if m["kind"] == "mirror":
        return dict(type="conductor", material="none")
    if m["kind"] == "glass":
        return dict(type="dielectric", int_ior=1.5, ext_ior=1.0)
    if m["kind"] == "lamp":
        return dict(type="diffuse", reflectance=dict(type="rgb", value=[0, 0, 0]))
    reflectance = dict(type="rgb", value=list(m["color"]))
    if m.get("vertex_colors"):
        reflectance = dict(type="mesh_attribute", name="vertex_color")
    if "texture" in m:
        linear = np.array(mi.Bitmap(m["texture"]).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False))
        reflectance = bitmap(linear * np.array(m["color"], np.float32), True)
    bsdf = dict(type="diffuse", reflectance=reflectance)
    if "normals" in m:
        bsdf = dict(type="normalmap", normalmap=bitmap(m["normals"], True), bsdf=bsdf)
    bsdf = dict(type="twosided", bsdf=bsdf)
    if "mask" in m:
        bsdf = dict(type="mask", opacity=bitmap(m["mask"], True, True), bsdf=bsdf)
    return bsdf


def shape_of(shape, m):
    positions, normals, uvs, triangles = shape
    scale = np.array(m.get("scale", (1, 1, 1)), np.float32)
    uvs = uvs_of(shape, m)  # v downwards, as the rows of a bitmap
    props = mi.Properties()
    props["bsdf"] = mi.load_dict(bsdf_of(m))
    if m["kind"] == "lamp":
        props["emitter"] = mi.load_dict(dict(type="area", radiance=dict(type="rgb", value=list(m["color"]))))
    mesh = mi.Mesh("mesh", len(positions), len(triangles), props, True, True)
    params = mi.traverse(mesh)
    if m.get("vertex_colors"):
        mesh.add_attribute("vertex_color", 3, (vertex_colors(positions) * np.array(m["color"], np.float32)).ravel())
    params["vertex_positions"], params["vertex_normals"] = (positions * scale).ravel(), (normals * scale).ravel()
    params["vertex_texcoords"], params["faces"] = uvs.astype(np.float32).ravel(), triangles.ravel()
    params.update()
    return mesh


def light_of(light):
    color = dict(type="rgb", value=list(light["color"]))
    if light["kind"] == "point":
        return dict(type="point", position=list(light["position"]), intensity=color)
    if light["kind"] == "directional":
        return dict(type="directional", direction=list(light["direction"]), irradiance=color)
    to_world = mi.ScalarTransform4f().look_at(origin=light["position"], target=TARGET, up=(0, 1, 0.1))
    return dict(type="spot", to_world=to_world, intensity=color, cutoff_angle=light["angle"], beam_width=light["angle"] - 0.05)


def by_mitsuba(scene, seed):
    world = dict(type="scene", integrator=dict(type="path", max_depth=64, rr_depth=16),
                 sensor=dict(type="perspective", fov=FOV, fov_axis="y", to_world=mi.ScalarTransform4f().look_at(EYE, TARGET, (0, 1, 0)),
                             film=dict(type="hdrfilm", width=WIDTH, height=HEIGHT, pixel_format="rgb", rfilter=dict(type="box")),
                             sampler=dict(type="independent", sample_count=SPP)))
    if max(scene.get("sky", SKY)) > 0:
        world["sky"] = dict(type="constant", radiance=dict(type="rgb", value=list(scene.get("sky", SKY))))
    if "light" in scene:
        world["light"] = light_of(scene["light"])
    for number, (shape, m) in enumerate(scene["parts"]):
        world["part%d" % number] = shape_of(shape, m)
    return np.array(mi.render(mi.load_dict(world), seed=seed))


def compare(claray, name, scene, path, folder):
    a = [by_claray(claray, path, scene, seed).mean((0, 1)) for seed in (1, 2)]
    b = [by_mitsuba(scene, seed) for seed in (1, 2)]
    if "CLARAY_PICTURES" in os.environ:
        both = np.hstack([read_pfm(folder + "/claray.pfm"), b[0]])
        Image.fromarray((255 * np.clip(both, 0, 1) ** (1 / 2.2)).astype(np.uint8)).resize((6 * WIDTH, 3 * HEIGHT)).save(
            "%s/%s%s.png" % (os.environ["CLARAY_PICTURES"], name, os.path.splitext(path)[1]))
    b = [image.mean((0, 1)) for image in b]
    ratio = np.mean(a, 0) / np.mean(b, 0)
    noise = 0.5 * np.hypot(np.subtract(*a) / np.mean(a, 0), np.subtract(*b) / np.mean(b, 0)).max()
    worst = np.abs(ratio - 1).max()
    print("%-18s %-4s %s  ratio %s  noise %.4f%s" % (name, os.path.splitext(path)[1][1:], np.array2string(np.mean(a, 0), precision=5),
                                                    np.array2string(ratio, precision=4), noise, "" if worst <= BAR else "  TOO FAR"),
          flush=True)
    return worst <= BAR


def main():
    claray, names = sys.argv[1], sys.argv[2:] or list(SCENES)
    good = True
    for name in names:
        scene = SCENES[name]
        with tempfile.TemporaryDirectory() as folder:
            Gltf(scene).write(folder + "/scene.gltf")
            good &= compare(claray, name, scene, folder + "/scene.gltf", folder)
            if not scene.get("gltf_only"):
                write_obj(scene, folder)
                good &= compare(claray, name, scene, folder + "/scene.obj", folder)
    sys.exit(0 if good else 1)


main()
