#!/usr/bin/env python3
"""claray.h by ctypes: no function crashes without arguments, and a render and queries work without a line of C.

Usage: call_by_ctypes.py LIBRARY
"""

import ctypes
import math
import os
import re
import sys
from pathlib import Path
from typing import Any

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).parent))
from bindings import Header  # noqa: E402

failures = 0


def expect(condition: bool, what: str) -> None:
    global failures
    if not condition:
        failures += 1
        print(f"{what}; last error: {call['claray_last_error']().decode()}")


def nothing(kind: Any) -> Any:
    """The argument of no value."""
    if kind in (ctypes.c_void_p, ctypes.c_char_p):
        return None
    return kind()


def reference(value: Any) -> Any:
    return ctypes.addressof(value)


def made(name: str, *arguments: Any) -> ctypes.c_void_p:
    """The handle that a function writes to its last argument."""
    handle = ctypes.c_void_p()
    expect(call[name](*arguments, reference(handle)) == 0 and handle.value is not None, name)
    return handle


def struct(name: str, **members: Any) -> Any:
    value = header.structs[name](ctypes.sizeof(header.structs[name]))
    for member, content in members.items():
        setattr(value, member, content)
    return value


def array(kind: Any, *values: Any) -> Any:
    return (kind * len(values))(*values)


def sweep_of_nothing() -> None:
    """All arguments NULL or 0: an error that tells the first argument, or nothing at all."""
    useless = {"claray_on_compiling",  # NULL ends the callbacks
               "claray_curve_data", "claray_gbuffer_unpack", "claray_tone_map_apply", "claray_false_color",
               "claray_identifier_color"}  # of no elements
    for name in header.functions:
        arguments = [nothing(kind) for kind in header.functions[name]._argtypes_]
        result = call[name](*arguments)
        if header.functions[name]._restype_ is not ctypes.c_int or name in useless or name == "claray_bvh_is_replaced":
            has_value = ("claray_version", "claray_matte_id")  # also of nothing: ids are normal floats
            expect(result in (None, 0, b"") or name in has_value, f"{name}() returns {result}")
            continue
        expect(result == 2, f"{name}() is {result} and no error of usage")
        told = re.match(r"(\w+)", call["claray_last_error"]().decode())
        names = [part.split("[")[0].split()[-1].lstrip("*") for part in header.arguments[name]]
        expect(told is not None and told[1] in names, f"{name}() tells no argument")


def sweep_of_sizes(handles: dict[str, ctypes.c_void_p]) -> None:
    """Structs of size 0 and of absurd size, with handles that exist: an error that tells the struct."""
    long_running = {"claray_prepare", "claray_device_model_measure"}
    for name, arguments in header.arguments.items():
        structs = [match[2] for part in arguments if (match := re.match(r"(const )?(claray_\w+)\*", part))
                   and match[2] in header.structs and header.structs[match[2]]._fields_[0][0] == "struct_size"]
        if not structs or name in long_running:
            continue
        for size in (0, 5000):
            values: list[Any] = []
            for part, kind in zip(arguments, header.functions[name]._argtypes_):
                of = re.match(r"(?:const )?(claray_\w+)\*( |$)", part)
                if of and of[1] in header.structs:
                    values.append(header.structs[of[1]]())
                    ctypes.memmove(reference(values[-1]), reference(ctypes.c_size_t(size)), ctypes.sizeof(ctypes.c_size_t))
                else:
                    values.append(handles.get(of[1]) if of else nothing(kind))
            result = call[name](*[reference(value) if isinstance(value, ctypes.Structure) else value for value in values])
            expect(result in (2, 3) or (result == 1), f"{name} with a struct of {size} bytes is {result}")


def test_render(device: ctypes.c_void_p) -> None:
    """A lit square fills the image: depth and colour are known."""
    scene = made("claray_scene_create")
    vertices = array(ctypes.c_float, -9, -9, 0, 9, -9, 0, 9, 9, 0, -9, 9, 0)
    triangles = array(ctypes.c_uint32, 0, 1, 2, 0, 2, 3)
    mesh = struct("claray_mesh", vertices=reference(vertices), vertex_count=4, triangles=reference(triangles), triangle_count=2)
    expect(call["claray_scene_mesh_set"](scene, 0, reference(mesh)) == 0, "mesh")
    material, camera, config = struct("claray_material"), struct("claray_camera"), struct("claray_render_config", width=8, height=4, spp=1)
    expect(call["claray_material_init"](reference(material)) == 0, "material")
    material.kind = b"unlit"
    material.albedo[:] = 0.25, 0.5, 0.75
    expect(call["claray_scene_material_set"](scene, 0, reference(material)) == 0, "material of the scene")
    expect(call["claray_camera_init"](reference(camera)) == 0 and camera.position[2] == 5, "camera")
    expect(call["claray_scene_camera_set"](scene, reference(camera)) == 0, "camera of the scene")
    renderer = made("claray_renderer_create", device, scene, reference(config))
    calls: list[int] = []
    kind = header.callbacks["claray_progress_callback"]
    pointer = ctypes.POINTER(header.structs["claray_progress"])
    callback = kind(lambda progress, user: calls.append(ctypes.cast(progress, pointer)[0].spp) or 1)
    reached = struct("claray_progress")
    expect(call["claray_renderer_render"](renderer, callback, None, reference(reached)) == 0 and reached.spp == 1, "render")
    expect(calls == [1] * len(calls) and len(calls) > 0, f"the callback got {calls}")
    image, depth = (ctypes.c_float * 96)(), (ctypes.c_float * 32)()
    expect(call["claray_renderer_image"](renderer, reference(image), 96) == 0, "image")
    expect(all(abs(image[i] - (0.25, 0.5, 0.75)[i % 3]) < 1e-6 for i in range(96)), f"the image has {image[0]}")
    expect(call["claray_renderer_layer"](renderer, b"depth", reference(depth), 32) == 0 and all(5 <= z < 7 for z in depth), "depth")
    bvh = made("claray_bvh_scene_build", device, scene, None)
    ray = header.structs["claray_ray"]()
    ray.origin[2], ray.direction[2], ray.tmax = 3, -1, math.inf
    lists = made("claray_all_hits_create", bvh, reference(ray), 1, None)
    expect(call["claray_lists_count"](lists) == 1, "lists")
    hits = ctypes.cast(call["claray_lists_hits"](lists), ctypes.POINTER(header.structs["claray_hit"]))
    expect(hits[0].t == 3, f"the hit is at {hits[0].t}")
    sweep_of_sizes({"claray_device": device, "claray_scene": scene, "claray_bvh": bvh, "claray_renderer": renderer, "claray_lists": lists})
    for name, handle in (("lists", lists), ("bvh", bvh), ("renderer", renderer), ("scene", scene)):
        call[f"claray_{name}_release"](handle)


header = Header()
call = header.bind(sys.argv[1])
if __name__ == "__main__":
    sweep_of_nothing()
    opened = made("claray_device_open", None if os.environ.get("CLARAY_DEVICE") else b"cpu")
    test_render(opened)
    call["claray_device_release"](opened)
    print(f"{len(header.functions)} functions, {failures} failures")
    sys.exit(1 if failures else 0)
