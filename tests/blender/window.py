"""What a window of Blender shows: the viewport after changes, and that a render begins. CTest does not run it, for bpy has no window:

    PYTHONPATH=FOLDER_OF_CLARAY xvfb-run -s "-screen 0 1280x800x24" blender --window-geometry 0 0 1280 800 --factory-startup \\
        --python-use-system-env --python tests/blender/window.py

Needs Blender 4.5 or later, claray for its Python, and ImageMagick. The end code is 0, or 1 with what is wrong.
"""

import os
import pathlib
import subprocess
import sys
import time

import bpy
import mathutils
import numpy as np
from bpy_extras.view3d_utils import location_3d_to_region_2d

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import support  # noqa: E402

SECONDS = 120  # for each step; the first one may compile kernels
WORLD = (0.2, 0.3, 0.4)
BOXES = {"red": ((-0.8, 0, 0), (0.8, 0.1, 0)), "green": ((0.8, 0, 0), (0, 0.5, 0.1)), "blue": ((0, 0.7, 0), (0.1, 0, 0.3))}


class Window:
    def __init__(self):
        self.window = bpy.context.window_manager.windows[0]
        area = next(area for area in self.window.screen.areas if area.type == "VIEW_3D")
        self.space, self.area = area.spaces[0], area
        self.region = next(region for region in area.regions if region.type == "WINDOW")
        self.seen = {}

    def look(self):
        """Keeps the colours on the screen at the places of the boxes, and between them."""
        width, height = self.window.width, self.window.height
        screen = subprocess.run(["import", "-window", "root", "-depth", "8", "rgb:-"], check=True, stdout=subprocess.PIPE).stdout
        screen = np.frombuffer(screen, np.uint8).reshape(height, width, 3)
        for name, place in {**{name: bpy.data.objects[name].location for name in BOXES}, "world": mathutils.Vector((0, -0.8, 0))}.items():
            at = location_3d_to_region_2d(self.region, self.space.region_3d, place)
            self.seen[name] = screen[height - 1 - int(self.region.y + at.y), int(self.region.x + at.x)] / 255

    def is_right(self):
        self.look()
        expected = {**{name: color for name, (_, color) in BOXES.items()}, "world": WORLD}
        return all(np.abs(self.seen[name] - encoded(color)).max() < 0.02 for name, color in expected.items())


def encoded(linear):
    """IEC 61966-2-1."""
    linear = np.array(linear)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def steps(shown):
    """Yields what must become true, as a name and a function, after each change."""
    support.load_addon()
    scene = bpy.context.scene
    for thing in list(scene.objects):
        bpy.data.objects.remove(thing)
    for name, (place, color) in BOXES.items():
        support.add_box(scene, (-0.3,) * 3, (0.3,) * 3, support.emission(color, name=name), name).location = place
    support.set_world(scene, WORLD)
    camera = support.add_camera(scene, (0, 0, 5), (0, 0, 0))
    camera.data.show_passepartout = False
    scene.view_settings.view_transform = "Standard"
    scene.render.engine = "CLARAY"
    shown.space.overlay.show_overlays = shown.space.show_gizmo = False
    shown.space.shading.type = "RENDERED"
    shown.space.region_3d.view_perspective = "CAMERA"
    yield "the viewport shows the scene through the camera", shown.is_right
    bpy.data.objects["red"].location, bpy.data.objects["green"].location = (0.8, 0.2, 0), (-0.8, -0.2, 0)
    yield "the viewport follows objects", shown.is_right
    shown.space.region_3d.view_perspective = "PERSP"
    shown.space.region_3d.view_distance = 4
    shown.space.region_3d.view_location = 0.2, 0, 0
    shown.space.region_3d.view_rotation = mathutils.Euler((0.3, 0.2, 1.0)).to_quaternion()
    yield "the viewport follows the view", shown.is_right
    shown.space.shading.type = "SOLID"
    scene.claray.samples = 2**20
    began = time.monotonic()
    with bpy.context.temp_override(window=shown.window):
        bpy.ops.render.render("INVOKE_DEFAULT")
    yield "a render goes on for 5 s", lambda: bpy.app.is_job_running("RENDER") and time.monotonic() - began > 5


def main():
    shown = Window()
    todo = steps(shown)
    name, is_done, end = None, None, 0.0

    def tick():
        nonlocal name, is_done, end
        try:
            if is_done is None or is_done():
                if name:
                    print(f"window.py: {name}", flush=True)
                name, is_done = next(todo)
                end = time.monotonic() + SECONDS
            elif time.monotonic() > end:
                raise TimeoutError(f"not within {SECONDS} s: {name}; seen: {shown.seen}")
        except StopIteration:
            os._exit(0)
        except BaseException as error:
            print(f"window.py: wrong: {type(error).__name__}: {error}", flush=True)
            os._exit(1)
        return 0.5

    bpy.context.preferences.view.show_splash = False
    bpy.app.timers.register(tick, first_interval=1, persistent=True)


main()
