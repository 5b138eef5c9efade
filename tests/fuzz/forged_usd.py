"""Changes small files of USD, and loads each by claray.usd: it is read, or refused by one line.

    PYTHONPATH=build/python build/python_env/bin/python tests/fuzz/forged_usd.py 2000 [FILE.usda FILE.usdc FILE.usdz ...]

Needs usd-core. Without files it makes its own: a mesh with a material, an image and subsets, instances, points, curves, solids, lights, a skeleton and a
camera. Files are loaded in a process of their own, which may take 4 GiB and 20 s for each. One that ends by a signal is a crash, of the library or of claray;
the last line says how many did. The exit status is 1 if anything but a refusal of one line came out of claray.
"""

import collections
import os
import random
import re
import resource
import signal
import sys
import tempfile
import warnings

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdShade, UsdSkel, UsdUtils

import claray
import claray.usd

MOST_BYTES, MOST_SECONDS = 4 << 30, 20
EDGES = (b"0", b"-1", b"1", b"4294967295", b"2147483648", b"1e39", b"-1e309", b"nan", b"inf", b"1e-42", b"[]", b"()", b'""', b"None", b"@@", b"</>", b"{}")
WORDS = (0, 1, 2, 3, 0xFF, 0x100, 0xFFFF, 0x10000, 0x1FFFFFFF, 0x55555555, 0x7F7FFFFF, 0x7F800000, 0x7FC00000, 0x7FFFFFFF, 0x80000000, 0xFF800000, 0xFFFFFFFE, 0xFFFFFFFF)


def material_of(stage, folder):
    pixels = np.array([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255, 255, 255]]], np.uint8)
    claray.Texture(pixels, "srgb").save(os.path.join(folder, "image.png"))
    material = UsdShade.Material.Define(stage, "/look")
    surface, image, place = (UsdShade.Shader.Define(stage, "/look/" + name) for name in ("surface", "image", "place"))
    surface.CreateIdAttr("UsdPreviewSurface"), image.CreateIdAttr("UsdUVTexture"), place.CreateIdAttr("UsdPrimvarReader_float2")
    image.CreateInput("file", Sdf.ValueTypeNames.Asset).Set("image.png")
    image.CreateInput("scale", Sdf.ValueTypeNames.Float4).Set((0.5, 0.5, 0.5, 1))
    place.CreateInput("varname", Sdf.ValueTypeNames.Token).Set("st")
    image.CreateInput("st", Sdf.ValueTypeNames.Float2).ConnectToSource(place.ConnectableAPI(), "result")
    surface.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).ConnectToSource(image.ConnectableAPI(), "rgb")
    surface.CreateInput("roughness", Sdf.ValueTypeNames.Float).Set(0.25)
    material.CreateSurfaceOutput().ConnectToSource(surface.ConnectableAPI(), "surface")
    return material


def mesh_of(stage, path):
    mesh = UsdGeom.Mesh.Define(stage, path)
    mesh.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1)])
    mesh.CreateFaceVertexCountsAttr([4, 3]), mesh.CreateFaceVertexIndicesAttr([0, 1, 2, 3, 0, 1, 4])
    UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("st", Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.faceVarying).Set([(0, 0)] * 7)
    return mesh


def skeleton_of(stage):
    root = UsdSkel.Root.Define(stage, "/bent")
    skeleton, mesh = UsdSkel.Skeleton.Define(stage, "/bent/bones"), mesh_of(stage, "/bent/skin")
    one = Gf.Matrix4d(1)
    skeleton.CreateJointsAttr(["a", "a/b"]), skeleton.CreateBindTransformsAttr([one, one]), skeleton.CreateRestTransformsAttr([one, one])
    binding = UsdSkel.BindingAPI.Apply(mesh.GetPrim())
    binding.CreateSkeletonRel().SetTargets([skeleton.GetPath()])
    binding.CreateJointIndicesPrimvar(False, 1).Set([0, 1, 0, 1, 0]), binding.CreateJointWeightsPrimvar(False, 1).Set([1.0] * 5)
    return root


def samples(folder):
    """The same stage as text, as crate and as archive."""
    stage = Usd.Stage.CreateNew(os.path.join(folder, "small.usda"))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    material, mesh = material_of(stage, folder), mesh_of(stage, "/mesh")
    UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(material)
    subset = UsdGeom.Subset.CreateGeomSubset(mesh, "part", UsdGeom.Tokens.face, [1], "materialBind")
    UsdShade.MaterialBindingAPI.Apply(subset.GetPrim()).Bind(material)
    copies = UsdGeom.PointInstancer.Define(stage, "/copies")
    UsdGeom.Sphere.Define(stage, "/copies/ball")
    copies.CreatePrototypesRel().SetTargets(["/copies/ball"])
    copies.CreateProtoIndicesAttr([0, 0]), copies.CreatePositionsAttr([(3, 0, 0), (6, 0, 0)])
    for kind in (UsdGeom.Cube, UsdGeom.Cylinder, UsdGeom.Cone, UsdGeom.Capsule):
        kind.Define(stage, "/" + kind.__name__)
    points = UsdGeom.Points.Define(stage, "/points")
    points.CreatePointsAttr([(0, 2, 0), (0, 3, 0)]), points.CreateWidthsAttr([0.1, 0.2])
    curves = UsdGeom.BasisCurves.Define(stage, "/curves")
    curves.CreateTypeAttr("linear"), curves.CreatePointsAttr([(0, 4, 0), (1, 4, 0), (1, 5, 0)]), curves.CreateCurveVertexCountsAttr([3])
    UsdLux.DomeLight.Define(stage, "/sky").CreateIntensityAttr(0.5)
    UsdLux.SphereLight.Define(stage, "/lamp").AddTranslateOp().Set((0, 0, 5))
    UsdGeom.Camera.Define(stage, "/camera").AddTranslateOp().Set((0, 0, 9), 0)
    skeleton_of(stage)
    stage.GetRootLayer().Save()
    stage.GetRootLayer().Export(os.path.join(folder, "small.usdc"))
    UsdUtils.CreateNewUsdzPackage(os.path.join(folder, "small.usda"), os.path.join(folder, "small.usdz"))
    return [os.path.join(folder, "small." + kind) for kind in ("usda", "usdc", "usdz")]


def changed(good, number):
    """The same on every platform for the same number."""
    pick = random.Random(number)
    file = bytearray(good)
    is_text = good.startswith(b"#usda")
    for _ in range(pick.randint(1, 4)):
        at = pick.randrange(len(file))
        way = pick.randrange(8)
        if way == 0:
            file[at] ^= 1 << pick.randrange(8)
        elif way == 1:
            del file[at:at + pick.choice((1, 4, 16, 64))]
        elif way == 2:
            file[at:at] = file[at:at + pick.choice((1, 8, 64))] if pick.random() < 0.5 else pick.randbytes(pick.choice((1, 4, 16)))
        elif way == 3 and pick.random() < 0.3:
            del file[max(at, 16):]
        elif is_text:
            tokens = list(re.finditer(rb"-?[0-9][0-9.e+-]*|[A-Za-z_:]+|\"[^\"]*\"", bytes(file)))
            if tokens:
                begin, end = pick.choice(tokens).span()
                file[begin:end] = pick.choice(EDGES) if way < 7 else pick.choice(tokens).group()
        else:
            word = pick.choice(WORDS) if way < 7 else max(int.from_bytes(file[at:at + 4], "little") + pick.choice((-1, 1)), 0) & 0xFFFFFFFF
            file[at:at + 4] = word.to_bytes(4, "little")
        if len(file) < 16:
            break
    return bytes(file)


def outcome_of(path):
    """'read', 'refused', or what else came out of claray."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            claray.usd.load(path)
    except claray.InputError as refusal:
        return "refused" if "\n" not in str(refusal) and path in str(refusal) else f"not one line with the file: {refusal}"
    except Exception as fault:
        return f"{type(fault).__name__}: {fault}".splitlines()[0]
    return "read"


def try_from(first, count, good, suffix, folder, pipe):
    """In the child: a line for each file."""
    resource.setrlimit(resource.RLIMIT_AS, (MOST_BYTES, MOST_BYTES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    for number in range(first, count):
        path = os.path.join(folder, f"forged_{number}{suffix}")  # the library keeps what it has read by its name
        with open(path, "wb") as file:
            file.write(changed(good, number))
        signal.alarm(MOST_SECONDS)
        line = outcome_of(path)
        signal.alarm(0)
        os.unlink(path)
        os.write(pipe, (line.replace("\n", " ")[:300] + "\n").encode("utf-8", "replace"))
        if number % 100 == 99:
            break  # layers of the library stay in its cache
    os._exit(0)


def tried(path, count):
    """How often each outcome came, and the numbers of those that are neither read nor refused."""
    with open(path, "rb") as file:
        good = file.read()
    suffix, counts, strange, done = os.path.splitext(path)[1], collections.Counter(), [], 0
    while done < count:
        reading, writing = os.pipe()
        child = os.fork()
        if child == 0:
            os.close(reading)
            try_from(done, count, good, suffix, os.path.dirname(path), writing)
        os.close(writing)
        with os.fdopen(reading, encoding="utf-8") as lines:
            for line in lines:
                kind = line.strip() if line.strip() in ("read", "refused") else "strange"
                counts[kind] += 1
                if kind == "strange":
                    strange.append((done, line.strip()))
                done += 1
        status = os.waitpid(child, 0)[1]
        if os.WIFSIGNALED(status):
            ended_by = signal.Signals(os.WTERMSIG(status)).name
            counts["too slow" if ended_by == "SIGALRM" else "crashed"] += 1
            strange.append((done, ended_by))
            done += 1
    return counts, strange


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 2000
    wrong = False
    with tempfile.TemporaryDirectory() as folder:
        for path in sys.argv[2:] or samples(folder):
            assert outcome_of(path) == "read", path
            counts, strange = tried(path, count)
            print(os.path.basename(path), count, "changes:", ", ".join(f"{number} {name}" for name, number in sorted(counts.items())), flush=True)
            for number, what in strange[:20]:
                print(f"  change {number}: {what}")
            wrong |= counts["strange"] > 0
    sys.exit(wrong)


if __name__ == "__main__":
    main()
