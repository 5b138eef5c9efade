"""The Python of docs/python.md and docs/sensors.md runs as it stands, block after block, with the arrays and files that it names."""

import ast
import asyncio
import base64
import inspect
import json
import pathlib
import re

import numpy as np
import pytest

import claray

DOCS = pathlib.Path(__file__).resolve().parents[3] / "docs"
# What a test has no time for, and what is not installed.
SMALLER = {"width=640, height=480, spp=256, error=0.01": "width=16, height=12, spp=4", "sensors.camera(640, 480": "sensors.camera(64, 48",
           "terrain:200000": "terrain:2000"}
NEEDS = {"Device.adopt": "pyopencl", "sensor_msgs": "sensor_msgs"}


def blocks(page):
    text = (DOCS / page).read_text(encoding="utf-8")
    for old, new in SMALLER.items():
        text = text.replace(old, new)
    return re.findall(r"^```python\n(.*?)^```", text, re.S | re.M)


def run(block, names):
    """Runs a block, which may await."""
    code = compile(block, "page", "exec", flags=ast.PyCF_ALLOW_TOP_LEVEL_AWAIT)
    if code.co_flags & inspect.CO_COROUTINE:
        asyncio.run(eval(code, names))
    else:
        exec(code, names)


def write_gltf(path, vertices, triangles):
    data = vertices.astype("<f4").tobytes() + triangles.astype("<u4").tobytes()
    place = len(vertices) * 12
    path.write_text(json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0}, {"mesh": 0, "translation": [3, 0, 0]}], "materials": [{"name": "plain"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
        "bufferViews": [{"buffer": 0, "byteLength": place}, {"buffer": 0, "byteOffset": place, "byteLength": triangles.size * 4}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(vertices), "type": "VEC3",
                       "min": vertices.min(0).tolist(), "max": vertices.max(0).tolist()},
                      {"bufferView": 1, "componentType": 5125, "count": triangles.size, "type": "SCALAR"}]}), encoding="utf-8")


@pytest.fixture(scope="module")
def names(tmp_path_factory):
    """What the pages take as given."""
    folder = tmp_path_factory.mktemp("pages")
    random = np.random.default_rng(1)
    ball = claray.load("ball:80").meshes[0]
    vertices, triangles = np.array(ball["vertices"]), np.array(ball["triangles"])
    for file in ("room.gltf", "city.gltf"):
        write_gltf(folder / file, vertices, triangles)
    for file in ("wood.png", "bumps.png", "sky.hdr"):
        random.random((8, 16, 3)).astype(np.float32).view(claray.Image).save(folder / file)
    placed = np.tile(np.eye(4)[:3], (4, 1, 1))
    placed[:, 0, 3] = range(4)
    own_kind = re.search(r'"cubes", R"\((.*?)\)"', (DOCS / "queries.md").read_text(encoding="utf-8"), re.S)
    assert own_kind is not None
    made = {"vertices": vertices, "triangles": triangles, "uvs": random.random((len(vertices), 2)), "points": random.normal(size=(9, 3)),
            "origins": random.normal(size=(9, 3)), "directions": random.normal(size=(9, 3)), "centers": random.normal(size=(9, 3)),
            "radii": random.uniform(0.1, 0.2, 9), "colors": random.random((9, 3)), "strands": random.normal(size=(5, 4, 3)), "source": own_kind[1],
            "data": random.random((3, 4)), "transforms": placed, "which": [0, 1, 0, 1], "leaf_transforms": placed,
            "branch_transforms": placed, "tree_transforms": placed, "i": 0, "matrix": np.eye(4), "matrix_at_shutter_close": placed[1],
            "show": lambda progress: None, "claray": claray}
    made["tree"] = made["rock"] = made["leaf"] = claray.Bvh(vertices, triangles)
    return folder, made


def add_queue(names):
    cl = pytest.importorskip("pyopencl")
    device = next(d for p in cl.get_platforms() for d in p.get_devices() if d.name.strip() == claray.default_device().name)
    context = cl.Context([device])
    queue, flags = cl.CommandQueue(context), cl.mem_flags.READ_WRITE
    rays = np.array(claray.rays(names["origins"], names["directions"]))
    names.update(context=context, queue=queue, count=len(rays), ray_buffer=cl.Buffer(context, flags, rays.nbytes),
                 hit_buffer=cl.Buffer(context, flags, len(rays) * claray.HIT.itemsize))
    names["written"] = cl.enqueue_copy(queue, names["ray_buffer"], rays, is_blocking=False)


@pytest.mark.parametrize("page", ["python.md", "sensors.md"])
def test_blocks_run(page, names, monkeypatch):
    folder, given = names
    monkeypatch.chdir(folder)
    own = dict(given)
    ran = 0
    for block in blocks(page):
        needs = next((module for word, module in NEEDS.items() if word in block), None)
        if "Pool" in block or needs == "sensor_msgs":  # processes of the tests' own, and ROS
            continue
        if needs == "pyopencl":
            add_queue(own)
        try:
            run(block, own)
        except Exception as error:
            raise AssertionError(f"{page}: {error}:\n{block}") from error
        ran += 1
    assert ran >= (2 if page == "sensors.md" else 9)
