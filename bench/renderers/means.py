"""Renders scenes whose models coincide with claray and with Mitsuba 3, and compares the means of the pictures.

    pip install mitsuba numpy pillow
    python3 bench/renderers/means.py build/bin/claray [NAME...]

Each scene is written as glTF or as OBJ and MTL, which claray reads, and handed to Mitsuba as its own shapes and BSDFs.
Prints a row a scene: the means of the three channels, their ratios, and the noise of each ratio. Exits with 1 where a
mean differs by more than 1 %.
"""
import os
import subprocess
import sys
import tempfile

import mitsuba as mi
import numpy as np
from PIL import Image

from gltf import Gltf
from meshes import ball, quad
from mitsuba_parts import light_of, shape_of, uvs_of
from scenes import read_pfm

mi.set_variant("scalar_rgb")

WIDTH, HEIGHT, SPP = 96, 72, 1024
EYE, TARGET, FOV, SKY = (0.3, 1.7, 4.0), (0.0, 0.5, 0.0), 42, (0.4, 0.5, 0.6)
BAR = 0.01


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
                 light=dict(kind="spot", position=(1, 2, 1), target=TARGET, color=(30, 20, 10), angle=25)),
    "mirrored-instance": dict(parts=[(FLOOR, diffuse()), (quad((0.6, 0.7, 0), (0.5, 0, 0.2), (0, 0.6, 0)),
                                                          diffuse((1, 1, 1), texture=TEXTURE, scale=(-1, 1, 1)))], gltf_only=True),
}


# ---- for claray

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
