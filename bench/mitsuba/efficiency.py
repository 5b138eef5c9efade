"""Efficiency 1 / (mean squared error x time) of claray over Mitsuba 3 with its multijitter sampler, at equal samples.

    pip install mitsuba numpy        (and LLVM, whose library DRJIT_LIBLLVM_PATH names)
    python3 bench/mitsuba/efficiency.py build/bin/claray [NAME...] [--sponza sponza.obj] [--spp 64] [--size 224] [--seeds 4]
    python3 bench/mitsuba/efficiency.py build/bin/claray [NAME...] --gpu --spp 256 --size 1024

Both render the same triangles, with box filters, to the same depth. The squared error is the variance of pixels over renders with
different seeds. Time is that of sampling: processor time, claray's by the difference of two renders; with --gpu by the clock, of Mitsuba's
variant for CUDA and of the first GPU that claray lists. Lamps emit on one side: their back is inside a closed black box, since
claray's lamps emit on both sides.
"""
import argparse
import json
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

import mitsuba as mi
import numpy as np

# ---- shapes: (positions, triangles); materials: (kind, values)


def quad(center, u, v):
    center, u, v = (np.array(x, float) for x in (center, u, v))
    return np.array([center - u - v, center + u - v, center + u + v, center - u + v]), np.array([[0, 1, 2], [0, 2, 3]])


def merged(*parts):
    starts = np.cumsum([0] + [len(p) for p, _ in parts])
    return np.concatenate([p for p, _ in parts]), np.concatenate([t + n for (_, t), n in zip(parts, starts)])


def box(center, half, turn=0.0, bottom=True):
    s, c = np.sin(turn), np.cos(turn)
    x, y, z = np.array([c, 0, -s]) * half[0], np.array([0, half[1], 0.0]), np.array([s, 0, c]) * half[2]
    m = np.array(center, float)
    sides = [quad(m + x, y, z), quad(m - x, z, y), quad(m + y, z, x), quad(m + z, x, y), quad(m - z, y, x)]
    return merged(*sides, *([quad(m - y, x, z)] if bottom else []))


def ball(center, radius, rows):
    theta, phi = np.meshgrid(np.linspace(0, np.pi, rows + 1), np.linspace(0, 2 * np.pi, 2 * rows + 1), indexing="ij")
    n = np.stack([np.sin(theta) * np.sin(phi), np.cos(theta), np.sin(theta) * np.cos(phi)], -1).reshape(-1, 3)
    a = (np.arange(rows)[:, None] * (2 * rows + 1) + np.arange(2 * rows)[None]).reshape(-1)
    b = a + 2 * rows + 1
    t, p = np.concatenate([np.stack([a, b, b + 1], -1), np.stack([a, b + 1, a + 1], -1)]), np.array(center) + radius * n
    area = np.linalg.norm(np.cross(p[t[:, 1]] - p[t[:, 0]], p[t[:, 2]] - p[t[:, 0]]), axis=1)
    return p, t[area > 1e-12]


def smooth_ball(center, radius, rows, material):
    """A part with vertex normals."""
    p, t = ball(center, radius, rows)
    return (p, t), material, (p - np.array(center)) / radius


def diffuse(*color):
    return "diffuse", color


def lamp(x, z, half, color, y=1.98):
    """A lamp that faces down, below a black box which it closes."""
    return [(quad((x, y, z), (half, 0, 0), (0, 0, half)), ("lamp", color)),
            (box((x, y + 0.005, z), (half, 0.005, half), bottom=False), diffuse(0, 0, 0))]


def room(w, h, d):
    """Open towards +z."""
    return [(quad((0, 0, 0), (w, 0, 0), (0, 0, -d)), diffuse(.7, .7, .7)), (quad((0, 2 * h, 0), (w, 0, 0), (0, 0, d)), diffuse(.7, .7, .7)),
            (quad((0, h, -d), (w, 0, 0), (0, h, 0)), diffuse(.7, .7, .7)), (quad((-w, h, 0), (0, 0, -d), (0, h, 0)), diffuse(.6, .1, .1)),
            (quad((w, h, 0), (0, 0, d), (0, h, 0)), diffuse(.1, .5, .1))]


def cornell():
    parts = [(box((-.35, .6, -.3), (.3, .6, .3), .3), diffuse(.7, .7, .7)), (box((.35, .3, .35), (.3, .3, .3), -.3), diffuse(.7, .7, .7))]
    return dict(parts=room(1, 1, 1) + parts + lamp(0, 0, .25, (15, 15, 15)), eye=(0, 1, 3.9), target=(0, 1, 0), fov=39, depth=8)


def hall():
    rng = np.random.default_rng(3)
    parts = room(3, 1, 3)
    for _ in range(10):
        parts.append((box((rng.uniform(-2.5, 2.5), .4, rng.uniform(-2.5, 2)), (.2, .4, .2), rng.uniform(0, 3)), diffuse(*rng.uniform(.3, .8, 3))))
    for i in range(16):
        parts += lamp(-2.2 + 1.5 * (i % 4), -2.2 + 1.3 * (i // 4), .1 + .05 * (i % 3), tuple(rng.uniform(5, 20, 3)), y=1.95)
    return dict(parts=parts, eye=(0, 1, 6.5), target=(0, .9, 0), fov=45, depth=8)


def glass():
    parts = [(ball((0, .5, .1), .45, 360), ("glass", 1.5))]
    return dict(parts=room(1, 1, 1) + parts + lamp(0, 0, .25, (15, 15, 15)), eye=(0, 1, 3.9), target=(0, 1, 0), fov=39, depth=12)


def window():
    """A room lit by the sky through a window."""
    white, floor = diffuse(.8, .8, .8), diffuse(.5, .4, .3)
    walls = [((0, 0, 0), (2, 0, 0), (0, 0, -2), floor), ((0, 2, 0), (2, 0, 0), (0, 0, 2), white), ((0, 1, -2), (2, 0, 0), (0, 1, 0), white),
             ((2, 1, 0), (0, 0, 2), (0, 1, 0), white), ((0, 1, 2), (2, 0, 0), (0, 1, 0), white), ((-2, .35, 0), (0, 0, -2), (0, .35, 0), white),
             ((-2, 1.8, 0), (0, 0, -2), (0, .2, 0), white), ((-2, 1.15, -1.4), (0, 0, -.6), (0, .45, 0), white),
             ((-2, 1.15, 1.4), (0, 0, -.6), (0, .45, 0), white)]
    parts = [(quad(c, u, v), m) for c, u, v, m in walls] + [(ball((.3, .5, -.5), .5, 48), diffuse(.6, .6, .7))]
    return dict(parts=parts, eye=(1.7, 1.1, 1.7), target=(-.5, .6, -.6), fov=60, depth=8, sky=(2, 2.2, 2.6))


def studio():
    """Smooth spheres under an environment with a small sun."""
    height, width = 1024, 2048
    y, x = np.meshgrid((np.arange(height) + .5) / height * np.pi, (np.arange(width) + .5) / width * 2 * np.pi, indexing="ij")
    image = np.where(y[..., None] < np.pi / 2, (.3, .4, .6), (.1, .09, .08)) + .1 * (1 + np.sin(7 * x) * np.sin(5 * y))[..., None]
    image += np.exp(-((y - .7) / .03) ** 2 - ((x - 2) / .03) ** 2)[..., None] * (400, 380, 300)
    rng = np.random.default_rng(1)
    parts = [smooth_ball((1.1 * (k % 3 - 1), .5, 1.1 * (k // 3 - 1)), .5, 64, diffuse(*rng.uniform(.2, .9, 3))) for k in range(9)]
    parts.append((quad((0, 0, 0), (8, 0, 0), (0, 0, -8)), diffuse(.5, .5, .5)))
    return dict(parts=parts, eye=(3, 2.5, 5), target=(0, .4, 0), fov=40, depth=8, environment=image)


def sponza(path):
    positions, triangles = [], []
    for line in open(path):
        words = line.split()
        if words[:1] == ["v"]:
            positions.append([float(x) for x in words[1:4]])
        elif words[:1] == ["f"]:
            face = [int(x.split("/")[0]) for x in words[1:]]
            face = [x - 1 if x > 0 else len(positions) + x for x in face]
            triangles += [[face[0], face[k], face[k + 1]] for k in range(1, len(face) - 1)]
    p, t = np.array(positions), np.array(triangles)
    low, high = p.min(0), p.max(0)
    middle, side = (low + high) / 2, (high - low).max()
    return dict(parts=[((p, t), diffuse(.7, .7, .7))], eye=tuple(middle + side * np.array([-.33, -.11, .01])),
                target=tuple(middle + side * np.array([.2, -.06, -.06])), fov=75, depth=5, sky=(.5, .5, .5))


# ---- the two renderers

def write_obj(scene, path):
    lines, materials, base, base_of_normals = [f"mtllib {path.stem}.mtl"], [], 1, 1
    for k, ((p, t), (kind, values), *normals) in enumerate(scene["parts"]):
        lines += [f"o p{k}", f"usemtl m{k}"] + ["v %.9g %.9g %.9g" % tuple(x) for x in p]
        lines += ["vn %.9g %.9g %.9g" % tuple(x) for n in normals for x in n]
        corner = "{0}//{1}" if normals else "{0}"
        lines += ["f " + " ".join(corner.format(i + base, i + base_of_normals) for i in x) for x in t]
        base, base_of_normals = base + len(p), base_of_normals + (len(p) if normals else 0)
        materials += [f"newmtl m{k}"] + {"diffuse": lambda: ["Kd %g %g %g" % values], "lamp": lambda: ["Kd 0 0 0", "Ke %g %g %g" % values],
                                         "glass": lambda: ["Kd 0 0 0", "Ks 1 1 1", "Ni %g" % values, "Tf 1 1 1", "illum 7"]}[kind]()
    path.write_text("\n".join(lines) + "\n")
    path.with_suffix(".mtl").write_text("\n".join(materials) + "\n")


def write_pfm(image, path):
    path.write_bytes(b"PF\n%d %d\n-1.0\n" % (image.shape[1], image.shape[0]) + image[::-1].astype("<f4").tobytes())


def read_pfm(path):
    with open(path, "rb") as file:
        file.readline()
        width, height = map(int, file.readline().split())
        file.readline()
        return np.frombuffer(file.read(), "<f4").reshape(height, width, 3).astype(float)


def by_claray(program, scene, size, spp, seeds, options, folder, gpu):
    path, image = pathlib.Path(folder) / "scene.obj", str(pathlib.Path(folder) / "image.pfm")
    write_obj(scene, path)
    words = ["%.9g,%.9g,%.9g" % tuple(scene[key]) if key in scene else "0,0,0" for key in ("eye", "target", "sky")]
    command = [program, "render", str(path), "-o", image, "--size", f"{size}x{size}", "--camera", words[0], "--look-at", words[1],
               "--fov", str(scene["fov"]), "--max-depth", str(scene["depth"]), "--wait-for-kernels", "-q", "--json", "--device", "gpu" if gpu else "cpu", *options]

    if "environment" in scene:
        write_pfm(scene["environment"], pathlib.Path(folder) / "environment.pfm")
        command += ["--environment", str(pathlib.Path(folder) / "environment.pfm")]
    else:
        command += ["--sky", words[2]]

    def run(samples, seed):
        """Processor time of the program, the clock's time of sampling, and the image."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        told = subprocess.run(command + ["--spp", str(samples), "--seed", str(seed)], check=True, stdout=subprocess.PIPE).stdout
        return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before, json.loads(told)["seconds"], read_pfm(image)

    run(spp, 0)  # compiles
    runs = [run(spp, k + 1) for k in range(seeds)]
    images = np.array([r[2] for r in runs])
    if gpu:
        return images, np.median([r[1] for r in runs])
    starts = [run(4, k + 1)[0] for k in range(seeds)]
    return images, (np.median([r[0] for r in runs]) - np.median(starts)) * spp / (spp - 4)


def bsdf_of(kind, values):
    if kind == "glass":
        return dict(type="dielectric", int_ior=values, ext_ior=1.0)
    color = values if kind == "diffuse" else (0, 0, 0)
    return dict(type="twosided", b=dict(type="diffuse", reflectance=dict(type="rgb", value=list(color)))) if kind == "diffuse" else \
        dict(type="diffuse", reflectance=dict(type="rgb", value=[0, 0, 0]))


def mesh_of(p, t, kind, values, normals):
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(bsdf_of(kind, values))
    if kind == "lamp":
        properties["emitter"] = mi.load_dict(dict(type="area", radiance=dict(type="rgb", value=list(values))))
    mesh = mi.Mesh("mesh", len(p), len(t), properties, has_vertex_normals=bool(normals))
    data = mi.traverse(mesh)
    for n in normals:
        data["vertex_normals"] = n.astype(np.float32).ravel()
    data["vertex_positions"], data["faces"] = p.astype(np.float32).ravel(), t.astype(np.uint32).ravel()
    data.update()
    return mesh


def by_mitsuba(scene, size, spp, seeds, gpu):
    seconds_now = time.perf_counter if gpu else time.process_time
    view = mi.ScalarTransform4f().look_at([float(x) for x in scene["eye"]], [float(x) for x in scene["target"]], [0, 1, 0])
    film = dict(type="hdrfilm", width=size, height=size, pixel_format="rgb", rfilter=dict(type="box"))
    loaded = dict(type="scene", integrator=dict(type="path", max_depth=scene["depth"] + 1, rr_depth=5),
                  sensor=dict(type="perspective", fov=scene["fov"], fov_axis="y", to_world=view, film=film,
                              sampler=dict(type="multijitter", sample_count=spp)))
    if "sky" in scene:
        loaded["sky"] = dict(type="constant", radiance=dict(type="rgb", value=list(scene["sky"])))
    if "environment" in scene:  # Mitsuba's first column is at -z, claray's middle one
        turned = np.roll(scene["environment"], scene["environment"].shape[1] // 2, 1).astype(np.float32)
        loaded["environment"] = dict(type="envmap", bitmap=mi.Bitmap(turned))
    for k, ((p, t), (kind, values), *normals) in enumerate(scene["parts"]):
        loaded[f"p{k}"] = mesh_of(p, t, kind, values, normals)
    world = mi.load_dict(loaded)
    np.array(mi.render(world, seed=100))  # compiles
    images, seconds = [], []
    for k in range(seeds):
        begin = seconds_now()
        images.append(np.array(mi.render(world, seed=k)).astype(float))
        seconds.append(seconds_now() - begin)
    return np.array(images), np.median(seconds)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("claray")
    parser.add_argument("names", nargs="*")
    parser.add_argument("--sponza", help="sponza.obj")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--size", type=int, default=224)
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--gpu", action="store_true")
    options = parser.parse_args()
    mi.set_variant("cuda_ad_rgb" if options.gpu else "llvm_ad_rgb")
    scenes = dict(cornell=cornell, hall=hall, glass=glass, window=window, studio=studio)
    if options.sponza:
        scenes["sponza"] = lambda: sponza(options.sponza)
    unknown = [name for name in options.names if name not in scenes]
    if unknown:
        sys.exit(f"unknown scene {unknown[0]}; choose from {' '.join(scenes)}")
    for name in options.names or scenes:
        scene = scenes[name]()
        with tempfile.TemporaryDirectory() as folder:
            rows = [("Mitsuba", *by_mitsuba(scene, options.size, options.spp, options.seeds, options.gpu))]
            settings = [[], ["--adaptive"]] + ([] if options.gpu else [["--no-guide"], ["--adaptive", "--no-guide"]])  # only CPUs guide
            for extra in settings:
                label = " ".join(extra) or "default"
                rows.append((label, *by_claray(os.path.abspath(options.claray), scene, options.size, options.spp, options.seeds, extra, folder, options.gpu)))
        costs = {label: images.var(0, ddof=1).mean() / images.mean() ** 2 * seconds for label, images, seconds in rows}
        for label, images, seconds in rows:
            print(f"{name:8} {label:21} mean {images.mean():.5f}  MSE {costs[label] / seconds:.3e}  {seconds:.3f} s"
                  f"  efficiency over Mitsuba {costs['Mitsuba'] / costs[label]:.2f}", flush=True)


if __name__ == "__main__":
    main()
