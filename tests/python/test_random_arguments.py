"""Every public function, constructor, method and property of claray, called with random right and wrong arguments.

A call must return, or raise an error of claray or a TypeError that names an argument. It must not crash or hang, nor raise anything
else. What is public is found by introspection, so that new functions are called, too. The calls run in a process of their own:

    python tests/python/test_random_arguments.py CALLS [SEED]

prints those that failed. The environment variable CLARAY_RANDOM_CALLS is the number of calls of the test, 2000 without it.
"""

import faulthandler
import importlib
import inspect
import json
import os
import pkgutil
import random
import re
import subprocess
import sys
import tempfile
import typing
import warnings
from pathlib import Path

import numpy as np

import claray
from claray import sensors

SECONDS_OF_A_HANG = 600
NEVER = {"accuracy", "benchmark", "verify"}  # they take seconds by design
NEVER |= {"add_bsdf", "install", "tell_compiling"}  # they change the process
HANDLES = {"context", "queue", "event", "rays", "results", "wait_for"}  # an integer there is an address, which nobody can check
CALLS_OF_RENDERERS = re.compile(r"render|bake|prepare|compile_kernels|approximation_error|explain", re.IGNORECASE)
SMALL = {"width": 8, "height": 8, "spp": 1, "size": 8, "samples": 1, "max_depth": 2}


class Broken:
    """An array that is none."""

    def __init__(self, kind):
        self.kind = kind

    def __repr__(self):
        return f"Broken({self.kind})"


class BrokenArray(Broken):
    def __array__(self, dtype=None, copy=None):
        if self.kind == "raises":
            raise RuntimeError("no array today")
        return {"text": "text", "object": np.array([None, {}], object)}[self.kind]


class BrokenDlpack(Broken):
    def __dlpack_device__(self):
        if self.kind == "device":
            return "nowhere"
        return (2, 0) if self.kind == "gpu" else (1, 0)

    def __dlpack__(self, **_):
        if self.kind == "raises":
            raise BufferError("no buffer today")
        return "capsule"


def wrong_value(dice):
    """What is hardly ever right."""
    n = dice.choice([0, 1, 2, 3, 7])
    array = np.random.default_rng(dice.randrange(2**32)).normal(size=(n, 3))
    return dice.choice([
        lambda: None, lambda: "up", lambda: "", lambda: b"bytes", lambda: 1j, lambda: object(), lambda: {}, lambda: {"x": 1}, lambda: set(),
        lambda: -1, lambda: 10**12, lambda: -(10**12), lambda: 2**64, lambda: 1e300, lambda: -0.5, lambda: float("nan"), lambda: float("inf"),
        lambda: True, lambda: [], lambda: [[]], lambda: [1, "a"], lambda: [[0, 0, 0], [0, 0]], lambda: (), lambda: range(3), lambda: int,
        lambda: lambda *given: None, lambda: BrokenArray("raises"), lambda: BrokenArray("text"), lambda: BrokenArray("object"),
        lambda: BrokenDlpack("raises"), lambda: BrokenDlpack("device"), lambda: BrokenDlpack("gpu"), lambda: BrokenDlpack("text"),
        lambda: array[:, :2], lambda: array.T, lambda: array * np.nan, lambda: array * 1e300, lambda: array.astype(complex),
        lambda: array.astype(str), lambda: array.astype(object), lambda: array.astype(bool), lambda: array[None], lambda: array[::-1, ::2],
        lambda: np.float64(3), lambda: np.array(3), lambda: np.zeros((3, 0)), lambda: np.array(["2026"], "M8[D]"), lambda: array.astype(">f4"),
        lambda: np.zeros(2, [("a", "f4")]), lambda: np.ma.masked_array(array), lambda: np.int8(-3), lambda: "\0", lambda: "x" * 5000,
        lambda: np.zeros((2, 3, 4, 5), np.uint16), lambda: memoryview(b"12345678"), lambda: Path("nowhere") / "x.obj",
    ])()


def right_array(name, dice, pool):
    rng = np.random.default_rng(dice.randrange(2**32))
    n = dice.choice([1, 4, 4, 4, 5])
    if "triangles" in name or "faces" in name or "indices" in name:
        return np.array([[0, 1, 2], [1, 2, 3]])
    if name in ("masks", "bottoms", "geometries", "segments", "meshes"):
        return np.zeros(n, int)
    if name in ("transforms", "transform", "ends", "transform_end"):
        one = np.hstack([np.eye(3), rng.normal(size=(3, 1))])
        return one if name in ("transform", "transform_end") else np.repeat(one[None], n, axis=0)
    if name in ("radii", "times", "tmin", "tmax", "offset"):
        return dice.choice([0.5, np.full(n, 0.5)])
    if name in ("origin", "end_point", "center", "position", "target"):
        return rng.normal(size=3)
    array = rng.normal(size=(n, 3)).astype(dice.choice(["f4", "f8", "f8"]))
    return dice.choice([lambda: array, lambda: array.tolist(), lambda: np.asfortranarray(array), lambda: np.repeat(array, 2, axis=0)[::2]])()


def right_value(name, annotation, dice, pool):
    """What fits the annotation, or the name."""
    if name in SMALL:
        return SMALL[name]
    choices = []
    choices += re.findall(r"['\"]([\w .-]+)['\"]", annotation) if "Literal" in annotation else []
    choices += [dice.choice(objects) for kind, objects in pool.items() if re.search(rf"\b{kind}\b", annotation)]
    for word, values in (("bool", (True, False)), ("int", (0, 1, 2)), ("float", (0.0, 0.5, 1.0)), ("str", ("cornell", "x")),
                         ("Callable", (lambda *given: None,)), ("PathLike", ("file",)), ("AnyDevice", (None, "cpu", 0)),
                         ("None", (None,)), ("Vector3|Numbers", ((0.5, 0.5, 0.5),))):
        if re.search(rf"\b({word})\b", annotation):
            choices.append(dice.choice(values))
    if "Structure" in annotation:
        choices += [dice.choice(pool[kind]) for kind in ("Bvh", "InstancedBvh", "Primitives") if kind in pool]
    if not choices or re.search("Array", annotation):
        choices.append(right_array(name, dice, pool))
    return dice.choice(choices)


def members_of(options):
    """Names and annotations of a TypedDict that **options unpack."""
    match = re.search(r"Unpack\[(\w+)\]", str(options))
    for module in [m for n, m in sys.modules.items() if n.startswith("claray")] if match else []:
        found = getattr(module, match[1], None)
        if found is not None:
            return {name: str(kind) for name, kind in found.__annotations__.items()}
    return {}


def arguments_for(signature, dice, pool, mistakes):
    """Keyword arguments: the right ones, of which some are replaced by wrong ones."""
    given = {}
    for parameter in signature.parameters.values():
        if parameter.kind in (parameter.VAR_POSITIONAL, parameter.POSITIONAL_ONLY):
            continue
        if parameter.kind == parameter.VAR_KEYWORD:
            known = members_of(parameter.annotation)
            for name in dice.sample(sorted(known), min(len(known), dice.choice([0, 1, 2]))):
                given[name] = right_value(name, known[name], dice, pool)
            given.update({name: value for name, value in SMALL.items() if name in known})
        elif parameter.default is parameter.empty or dice.random() < 0.3:
            given[parameter.name] = right_value(parameter.name, str(parameter.annotation), dice, pool)
    for name in dice.sample(sorted(given), min(len(given), mistakes)):
        value = wrong_value(dice)
        if name in HANDLES:
            while isinstance(value, int) and not isinstance(value, bool):
                value = wrong_value(dice)
        given[name] = value
    return given


def modules():
    yield claray
    for info in pkgutil.walk_packages(claray.__path__, "claray."):
        if not any(part.startswith("_") for part in info.name.split(".")):
            try:
                yield importlib.import_module(info.name)
            except ImportError:
                pass  # of a library that is not installed


def public(owner):
    """Names and values of what is claray's own; of a module without __all__, what it defines."""
    for name in sorted(getattr(owner, "__all__", None) or vars(owner)):
        value = getattr(owner, name)
        home = getattr(value, "__module__", None) or ""
        if not name.startswith("_") and (home.split(".")[0] == "claray" if hasattr(owner, "__all__") else home == owner.__name__):
            yield name, value


def is_own(kind, member):
    """Whether a class of claray defines the member, and not one of NumPy that it derives from."""
    home = next((base for base in kind.__mro__ if member in vars(base)), object)
    return home.__module__.split(".")[0] == "claray"


def calls_of(pool):
    """All calls as (text, function, names of what takes the value of a property, or None)."""
    seen = set()
    for module in modules():
        for name, value in public(module):
            if id(value) in seen or name in NEVER or isinstance(value, type) and issubclass(value, Exception):
                continue
            seen.add(id(value))
            text = f"{module.__name__}.{name}"
            if typing.get_origin(value) is not None or not callable(value):
                continue
            if not isinstance(value, type) or is_own(value, "__init__") or is_own(value, "__new__"):
                yield text, value, None
            if not isinstance(value, type):
                continue
            for member, static in inspect.getmembers_static(value):
                if isinstance(static, (classmethod, staticmethod)) and not member.startswith("_") and is_own(value, member):
                    yield f"{text}.{member}", getattr(value, member), None
            for instance in pool.get(name, ()):
                yield from calls_of_instance(text, instance)


def calls_of_instance(text, instance):
    for member, static in inspect.getmembers_static(type(instance)):
        if (member.startswith("_") and member != "__call__" or isinstance(static, (classmethod, staticmethod)) or member in NEVER
                or not is_own(type(instance), member)):
            continue
        if callable(static) and inspect.isroutine(static):
            yield f"{text}().{member}", getattr(instance, member), None
        elif not callable(static) and hasattr(type(static), "__get__"):
            yield f"{text}().{member}", instance, member


def new_pool():
    """An object of each kind that calls are made of; those that calls return are added."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    bvh = claray.Bvh(corners, faces)
    pool = {"Bvh": [bvh, claray.Bvh(corners, faces[:2])], "Scene": [claray.load("cornell"), claray.Scene()], "Device": [bvh.device],
            "Primitives": [claray.Primitives.spheres(corners, 0.1)], "InstancedBvh": [claray.InstancedBvh(bvh, [np.eye(4)[:3]])],
            "Query": [claray.Query(bvh)], "Filter": [claray.geometry_range(0, 1)], "Rays": [claray.rays(corners, corners + 1)],
            "Material": [claray.Material()], "Light": [claray.Light("point")], "Camera": [claray.Camera()],
            "Renderer": [claray.Renderer(claray.load("cornell"), **{k: SMALL[k] for k in ("width", "height", "spp")})]}
    world = sensors.World(claray.load("cornell"), movers=[0])
    lidar = sensors.Sensor(world, sensors.raster(2, 3))
    pool |= {"World": [world], "Pattern": [lidar.pattern], "Sensor": [lidar], "Scan": [lidar.scan(np.eye(4))]}
    try:
        import trimesh
        pool["Trimesh"] = [trimesh.Trimesh(corners, faces)]
    except ImportError:
        pass
    return pool


def keep(result, pool):
    kind = type(result).__name__
    if type(result).__module__.split(".")[0] == "claray" and len(pool.setdefault(kind, [])) < 3:
        pool[kind].append(result)


def complaint(call, error, given):
    """What is wrong with an error; None if nothing is."""
    if not isinstance(error, (claray.Error, TypeError)):
        return "another exception"
    if "\n" in str(error).strip() and not isinstance(error, claray.DeviceError):
        return "more than one line"
    names = {*given, *call}
    if "origins" in names:
        names.add("rays")  # origins and directions in one array
    if isinstance(error, (claray.UsageError, TypeError)) and given and not any(re.search(rf"\b{n}s?\b", str(error)) for n in names):
        return "names no argument"
    return None


def shown(given):
    try:
        return re.sub(r" at 0x[0-9a-f]+", "", repr(given))
    except Exception as error:
        return f"(no repr: {error})"


def run(count, seed, note):
    """Makes `count` calls. Returns what failed, by the text of the call and the complaint, and how many different calls there were."""
    dice, failures, told = random.Random(seed), {}, set()
    for number in range(count):
        if number % 250 == 0:
            pool = new_pool()
            calls = list(calls_of(pool))
        text, function, member = dice.choice(calls)
        if CALLS_OF_RENDERERS.search(text) and dice.random() < 0.7:
            continue  # they take longest
        told.add(text)
        mistakes = dice.choice([0, 1, 1, 1, 2, 3])
        given = {}
        try:
            if member is not None:
                given = {member: wrong_value(dice)} if mistakes else {}
                note(text, given)
                if mistakes:
                    setattr(function, member, given[member])
                getattr(function, member)
                continue
            try:
                signature = inspect.signature(function)
            except ValueError:
                continue  # of a class of C
            given = arguments_for(signature, dice, pool, mistakes)
            note(text, given)
            keep(function(**given), pool)
        except Exception as error:
            names = set() if member is not None else set(signature.parameters)
            if isinstance(error, AttributeError) and member is not None and member in str(error):
                continue  # a property that cannot be set
            wrong = complaint(names, error, given)
            if wrong:
                key = f"{text}: {wrong}: {type(error).__name__}"
                failures.setdefault(key, f"{shown(given)[:1500]} -> {str(error)[:300]}")
    return failures, told


def main():
    count, seed = int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 1
    log = os.open(os.environ.get("CLARAY_RANDOM_LOG", os.devnull), os.O_WRONLY | os.O_CREAT)
    warnings.simplefilter("ignore")
    np.seterr(all="ignore")
    faulthandler.enable()

    def note(text, given):
        faulthandler.dump_traceback_later(SECONDS_OF_A_HANG, exit=True)
        os.pwrite(log, f"{text} {shown(given)}"[:2000].ljust(2000).encode("utf-8", "replace"), 0)

    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        failures, told = run(count, seed, note)
        os.chdir("/")
    faulthandler.cancel_dump_traceback_later()
    print(json.dumps({"calls": count, "different": sorted(told), "failures": failures}, indent=1))


def test_errors_name_their_arguments(tmp_path):
    count = os.environ.get("CLARAY_RANDOM_CALLS", "2000")
    log = tmp_path / "last call"
    done = subprocess.run([sys.executable, __file__, count, "1"], capture_output=True, text=True,
                          env={**os.environ, "CLARAY_RANDOM_LOG": str(log)})
    last = log.read_bytes().decode("utf-8", "replace").strip() if log.exists() else ""
    assert done.returncode == 0, f"status {done.returncode} in {last}: {done.stderr[-2000:]}"
    result = json.loads(done.stdout)
    assert len(result["different"]) > 150  # how many functions, methods and properties were called
    assert not result["failures"], json.dumps(result["failures"], indent=1)


if __name__ == "__main__":
    main()
