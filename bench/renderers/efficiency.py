"""Efficiency 1 / (mean squared error x time) of claray over Mitsuba 3 with its multijitter sampler, or over Blender's Cycles, at equal samples.

    pip install mitsuba numpy        (for glTF also pillow; and LLVM, whose library DRJIT_LIBLLVM_PATH names)
    python3 bench/renderers/efficiency.py build/bin/claray [NAME...] [--sponza sponza.obj] [--spp 64] [--size 224] [--seeds 4]
    python3 bench/renderers/efficiency.py build/bin/claray [NAME...] --gpu --spp 256 --size 1024
    python3 bench/renderers/efficiency.py build/bin/claray [NAME...] --peer cycles        (Debian's package blender, or PyPI's bpy)

Six scenes are written as OBJ. Five of gltf_scenes.py are rendered if they are named: textured-room bottles metals lamps leaves.
Both render the same triangles, with box filters, to the same depth. The squared error is the variance of pixels over renders with
different seeds. Time is that of sampling, of all processors and by the clock: neither loading, nor building trees, nor compiling
kernels. On GPUs it is by the clock, of Mitsuba's variant for CUDA and of the first GPU that claray lists. "Apart" is the squared
difference of the mean pictures over that which their variances explain: 1 where they differ by noise alone.
"""
import argparse
import csv
import json
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from typing import NamedTuple

import numpy as np

import gltf_scenes
import scenes
from scenes import read_pfm, write_obj, write_pfm

COLUMNS = ("scene", "size", "spp", "peer", "setting", "mean", "apart", "squared_error", "processor_seconds", "clock_seconds",
           "efficiency_by_processor", "efficiency_by_clock")
CYCLES = pathlib.Path(__file__).with_name("cycles.py")


class Renders(NamedTuple):
    images: np.ndarray  # a seed each
    processor: float    # seconds of all threads, of one image; claray's on GPUs is not measured
    clock: float

    def squared_error(self):
        """Relative to the square of the mean."""
        return self.images.var(0, ddof=1).mean() / self.images.mean() ** 2


def is_gltf(scene):
    return len(scene["parts"][0][0]) == 4  # meshes of meshes.py


def write_for_claray(scene, folder):
    """Returns the words of the command line that name the scene."""
    path, environment = pathlib.Path(folder) / ("scene.gltf" if is_gltf(scene) else "scene.obj"), pathlib.Path(folder) / "environment.pfm"
    if is_gltf(scene):
        from gltf import Gltf  # needs Pillow
        Gltf(scene).write(path)
    else:
        write_obj(scene, path)
    eye, target, sky = ("%.9g,%.9g,%.9g" % tuple(scene.get(key, (0, 0, 0))) for key in ("eye", "target", "sky"))
    words = [str(path), "--camera", eye, "--look-at", target, "--fov", str(scene["fov"]), "--max-depth", str(scene["depth"])]
    if "environment" not in scene:
        return words + ["--sky", sky]
    write_pfm(scene["environment"], environment)
    return words + ["--environment", str(environment)]


def by_claray(program, words, size, spp, seeds, options, folder, gpu):
    """`words`: of write_for_claray. Processor time is the difference of two renders."""
    image = str(pathlib.Path(folder) / "image.pfm")
    command = [program, "render", *words, "-o", image, "--size", f"{size}x{size}", "--wait-for-kernels", "-q", "--json",
               "--device", "gpu" if gpu else "cpu", *options]

    def run(samples, seed):
        """Processor time of the program, the clock's time of sampling, and the image."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        told = subprocess.run(command + ["--spp", str(samples), "--seed", str(seed)], check=True, stdout=subprocess.PIPE).stdout
        return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before, json.loads(told)["seconds"], read_pfm(image)

    run(spp, 0)  # compiles
    runs = [run(spp, k + 1) for k in range(seeds)]
    images, clock = np.array([r[2] for r in runs]), np.median([r[1] for r in runs])
    if gpu:
        return Renders(images, float("nan"), clock)
    starts = [run(4, k + 1)[0] for k in range(seeds)]
    return Renders(images, (np.median([r[0] for r in runs]) - np.median(starts)) * spp / (spp - 4), clock)


def mitsuba_bsdf(kind, values):
    if kind == "glass":
        return dict(type="dielectric", int_ior=values, ext_ior=1.0)
    if kind == "lamp":
        return dict(type="diffuse", reflectance=dict(type="rgb", value=[0, 0, 0]))
    return dict(type="twosided", b=dict(type="diffuse", reflectance=dict(type="rgb", value=list(values))))


def mitsuba_mesh(mi, p, t, kind, values, normals):
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(mitsuba_bsdf(kind, values))
    if kind == "lamp":
        properties["emitter"] = mi.load_dict(dict(type="area", radiance=dict(type="rgb", value=list(values))))
    mesh = mi.Mesh("mesh", len(p), len(t), properties, has_vertex_normals=bool(normals))
    data = mi.traverse(mesh)
    for n in normals:
        data["vertex_normals"] = n.astype(np.float32).ravel()
    data["vertex_positions"], data["faces"] = p.astype(np.float32).ravel(), t.astype(np.uint32).ravel()
    data.update()
    return mesh


def by_mitsuba(scene, size, spp, seeds, gpu, sampler="multijitter"):
    import mitsuba as mi
    mi.set_variant("cuda_ad_rgb" if gpu else "llvm_ad_rgb")
    view = mi.ScalarTransform4f().look_at([float(x) for x in scene["eye"]], [float(x) for x in scene["target"]], [0, 1, 0])
    film = dict(type="hdrfilm", width=size, height=size, pixel_format="rgb", rfilter=dict(type="box"))
    loaded = dict(type="scene", integrator=dict(type="path", max_depth=scene["depth"] + 1, rr_depth=5),
                  sensor=dict(type="perspective", fov=scene["fov"], fov_axis="y", to_world=view, film=film,
                              sampler=dict(type=sampler, sample_count=spp)))
    if "sky" in scene:
        loaded["sky"] = dict(type="constant", radiance=dict(type="rgb", value=list(scene["sky"])))
    if "environment" in scene:  # Mitsuba's first column is at -z, claray's middle one
        turned = np.roll(scene["environment"], scene["environment"].shape[1] // 2, 1).astype(np.float32)
        loaded["environment"] = dict(type="envmap", bitmap=mi.Bitmap(turned))
    if is_gltf(scene):
        import mitsuba_parts
        loaded.update((f"p{k}", mitsuba_parts.shape_of(*part)) for k, part in enumerate(scene["parts"]))
        if "light" in scene:
            loaded["light"] = mitsuba_parts.light_of(scene["light"])
    else:
        for k, ((p, t), (kind, values), *normals) in enumerate(scene["parts"]):
            loaded[f"p{k}"] = mitsuba_mesh(mi, p, t, kind, values, normals)
    world = mi.load_dict(loaded)
    np.array(mi.render(world, seed=100))  # compiles
    images, processor, clock = [], [], []
    for k in range(seeds):
        begin = time.process_time(), time.perf_counter()
        images.append(np.array(mi.render(world, seed=k)).astype(float))
        processor.append(time.process_time() - begin[0]), clock.append(time.perf_counter() - begin[1])
    return Renders(np.array(images), np.median(processor), np.median(clock))


def camera_to_world(scene):
    """Rows; the camera looks along -z."""
    back = np.array(scene["eye"], float) - np.array(scene["target"], float)
    back /= np.linalg.norm(back)
    right = np.cross((0, 1, 0), back)
    right /= np.linalg.norm(right)
    rows = np.eye(4)
    rows[:3] = np.stack([right, np.cross(back, right), back, scene["eye"]], 1)
    return rows.tolist()


def write_for_cycles(scene, size, spp, seeds, folder):
    def write(name, values, kind):
        (pathlib.Path(folder) / name).write_bytes(np.ascontiguousarray(values, kind).tobytes())
        return name

    parts = [dict(positions=write(f"p{k}.f32", p, np.float32), triangles=write(f"t{k}.u32", t, np.uint32), kind=kind, values=values,
                  normals=write(f"n{k}.f32", normals[0], np.float32) if normals else None)
             for k, ((p, t), (kind, values), *normals) in enumerate([] if is_gltf(scene) else scene["parts"])]
    view = dict(parts=parts, size=size, spp=spp, seeds=seeds, threads=len(os.sched_getaffinity(0)), bounces=scene["depth"] - 1,
                fov=np.radians(scene["fov"]), camera_to_world=camera_to_world(scene), sky=scene.get("sky", (0, 0, 0)))
    if is_gltf(scene):
        from gltf import Gltf
        Gltf(scene).write(pathlib.Path(folder) / "scene.gltf")
        view["gltf"] = "scene.gltf"
    if "environment" in scene:
        image = scene["environment"]
        view["environment"] = image.shape[1], image.shape[0]
        write("environment.f32", np.concatenate([image[::-1], np.ones_like(image[..., :1])], -1), np.float32)
    (pathlib.Path(folder) / "view.json").write_text(json.dumps(view))


def by_cycles(scene, size, spp, seeds):
    with tempfile.TemporaryDirectory() as folder:
        write_for_cycles(scene, size, spp, seeds, folder)
        command = ["blender", "-b", "--factory-startup", "--python-exit-code", "1", "--python"] if shutil.which("blender") else [sys.executable, "-P"]
        told = subprocess.run([*command, str(CYCLES), "--", folder], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if told.returncode:
            sys.exit("Cycles failed: " + told.stdout[-2000:])
        images = np.array([read_pfm(pathlib.Path(folder) / f"{k}.pfm") for k in range(seeds)])
    times = re.findall(r"^seconds (\S+) (\S+)$", told.stdout, re.M)
    return Renders(images, *np.median(np.array(times, float), 0))


def apart(ours, theirs):
    explained = ours.images.var(0, ddof=1).mean() / len(ours.images) + theirs.images.var(0, ddof=1).mean() / len(theirs.images)
    return ((ours.images.mean(0) - theirs.images.mean(0)) ** 2).mean() / explained


def row(name, label, renders, peer, options):
    """For --csv: the efficiencies are over the peer's."""
    ratio = peer.squared_error() / renders.squared_error()
    values = [renders.images.mean(), 0 if renders is peer else apart(renders, peer), renders.squared_error(), renders.processor, renders.clock,
              ratio * peer.processor / renders.processor, ratio * peer.clock / renders.clock]
    return [name, options.size, options.spp, options.peer, label, *(f"{x:.6g}" for x in values)]


def report(name, label, renders, peer, gpu):
    ratio = peer.squared_error() / renders.squared_error()
    processor = "" if gpu else f"  {renders.processor:.3f} s of processors, efficiency {ratio * peer.processor / renders.processor:.2f}"
    print(f"{name:13} {label:21} mean {renders.images.mean():.5f}  apart {0 if renders is peer else apart(renders, peer):.3f}"
          f"  MSE {renders.squared_error():.3e}{processor}  {renders.clock:.3f} s by the clock, efficiency {ratio * peer.clock / renders.clock:.2f}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("claray")
    parser.add_argument("names", nargs="*")
    parser.add_argument("--peer", choices=["mitsuba", "cycles"], default="mitsuba")
    parser.add_argument("--sponza", help="sponza.obj")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--size", type=int, default=224)
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--gpu", action="store_true", help="with Mitsuba only")
    parser.add_argument("--defaults", action="store_true", help="of claray only the default, and of Mitsuba also its default sampler")
    parser.add_argument("--csv", help="a row for each renderer and setting")
    parser.add_argument("--pictures", help="folder for the first picture of each renderer, as .pfm")
    options = parser.parse_args()
    if options.gpu and options.peer == "cycles":
        parser.error("--gpu needs Mitsuba: Cycles of Debian has no kernels for OpenCL or CUDA")
    usual = scenes.all_scenes(options.sponza)
    known = usual | gltf_scenes.all_scenes()
    unknown = [name for name in options.names if name not in known]
    if unknown:
        parser.error(f"unknown scene {unknown[0]}; choose from {' '.join(known)}")
    settings = [[], ["--adaptive"]] + ([] if options.gpu else [["--no-guide"], ["--adaptive", "--no-guide"]])  # only CPUs guide
    table = []
    for name in options.names or usual:
        scene = known[name]()
        size, spp, seeds = options.size, options.spp, options.seeds
        peer = by_cycles(scene, size, spp, seeds) if options.peer == "cycles" else by_mitsuba(scene, size, spp, seeds, options.gpu)
        rows = [(options.peer, peer)]
        if options.defaults and options.peer == "mitsuba":
            rows.append(("mitsuba, independent", by_mitsuba(scene, size, spp, seeds, options.gpu, "independent")))
        with tempfile.TemporaryDirectory() as folder:
            words = write_for_claray(scene, folder)
            for extra in settings[:1] if options.defaults else settings:
                rows.append((" ".join(extra) or "default", by_claray(os.path.abspath(options.claray), words, size, spp, seeds, extra, folder, options.gpu)))
        for label, renders in rows:
            report(name, label, renders, peer, options.gpu)
            table.append(row(name, label, renders, peer, options))
            if options.pictures:
                os.makedirs(options.pictures, exist_ok=True)
                write_pfm(renders.images[0], pathlib.Path(options.pictures) / f"{name}_{label.replace(' ', '')}.pfm")
    if options.csv:
        with open(options.csv, "w", newline="") as file:
            csv.writer(file).writerows([COLUMNS, *table])


if __name__ == "__main__":
    main()
