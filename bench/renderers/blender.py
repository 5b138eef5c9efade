"""Measures the add-on for Blender (tools/blender): seconds from F12 to the picture, and means beside Cycles.

    PYTHONPATH=build/python build/blender_env/bin/python -P bench/renderers/blender.py [--size WxH] [--spp N] [--frames N] [SCENE...]
    PYTHONPATH=build/python build/blender_env/bin/python -P bench/renderers/blender.py --means [--size WxH] [--spp N]

Needs PyPI's bpy, which tests/blender/run installs in build/blender_env. (-P: cycles.py beside this file has the name of Blender's add-on.)
Scenes: cube (Blender's default), room (an interior), instances (1,000 of one mesh), frames (an animation of the cube). Prints a row for each:
seconds of the first render, which may compile kernels; of the median of three later ones, for frames of the slowest frame after the first, by the
clock and of all processors; of Cycles with as many samples; and the mean by claray over that by Cycles of red, green and blue.
--means prints only the latter, for each kind of lamp, the world, and cameras with a shift and with depth of field.
"""

import argparse
import math
import pathlib
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tests/blender"))
import support  # noqa: E402


def cube(width, height):
    return support.default_scene(width, height)


def room(width, height):
    scene = support.empty_scene(width, height)
    support.interior(scene)
    return scene


def instances(width, height):
    scene = support.empty_scene(width, height)
    support.instances(scene, 1000)
    return scene


def frames(width, height):
    scene = support.default_scene(width, height)
    import bpy
    cube = bpy.data.objects["Cube"]
    for frame, angle in ((1, 0), (24, math.pi)):
        cube.rotation_euler.z = angle
        cube.keyframe_insert("rotation_euler", frame=frame)
    return scene


def world_of_one_color(width, height):
    scene = support.empty_scene(width, height)
    support.add_box(scene, (-1, -1, 0), (1, 1, 0.5), support.diffuse((0.8, 0.6, 0.4)))
    support.set_world(scene, (0.2, 0.3, 0.5), 1.5)
    return scene


def world_of_an_image(width, height):
    scene = support.empty_scene(width, height)
    support.below_image(scene, 1.0)
    return scene


def shifted_camera(width, height):
    scene = room(width, height)
    scene.camera.data.shift_x, scene.camera.data.shift_y = 0.1, -0.05
    return scene


def depth_of_field(width, height):
    scene = room(width, height)
    dof = scene.camera.data.dof
    dof.use_dof, dof.aperture_fstop, dof.focus_distance = True, 0.1, 3.5
    return scene


def lamp(name):
    def make(width, height):
        scene = support.empty_scene(width, height)
        support.below_lamp(scene, name)
        return scene
    return make


def print_means(width, height, samples):
    made = {**{f"lamp: {name}": lamp(name) for name in support.LAMPS}, "world: a colour": world_of_one_color, "world: an image": world_of_an_image,
            "camera: shift": shifted_camera, "camera: depth of field": depth_of_field}
    for name, make in made.items():
        ours, cycles = (pixels.mean((0, 1)) for pixels in support.both(make(width, height), samples))
        print(f"{name:24} {' '.join(f'{share:.4f}' for share in ours / cycles)}", flush=True)


def timed(scene, engine, samples, frame=None):
    """Seconds by the clock, those of all processors, and the mean."""
    begin, processors = time.perf_counter(), time.process_time()
    pixels = support.picture(scene, engine, samples, frame)
    return time.perf_counter() - begin, time.process_time() - processors, pixels[..., :3].mean((0, 1))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", default=["cube", "room", "instances", "frames"], metavar="SCENE")
    parser.add_argument("--size", default="640x360")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--frames", type=int, default=24)
    parser.add_argument("--means", action="store_true")
    given = parser.parse_args()
    width, height = map(int, given.size.split("x"))
    if given.means:
        print_means(width, height, given.spp)
        return
    print(f"{given.size}, {given.spp} samples\n{'scene':10} first later processors Cycles processors  claray/Cycles")
    for name in given.scenes:
        scene = {"cube": cube, "room": room, "instances": instances, "frames": frames}[name](width, height)
        first, _, mean = timed(scene, "CLARAY", given.spp)
        if name == "frames":
            later, processors, _ = max((timed(scene, "CLARAY", given.spp, frame) for frame in range(2, given.frames + 1)), key=lambda of: of[0])
            scene.frame_set(1)
        else:
            later, processors, _ = sorted((timed(scene, "CLARAY", given.spp) for _ in range(3)), key=lambda of: of[0])[1]
        cycles, of_cycles, expected = timed(scene, "CYCLES", given.spp)
        print(f"{name:10} {first:5.2f} {later:5.2f} {processors:10.2f} {cycles:6.2f} {of_cycles:10.2f}  "
              f"{' '.join(f'{share:.4f}' for share in mean / expected)}", flush=True)


main()
