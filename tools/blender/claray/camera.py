# SPDX-License-Identifier: GPL-3.0-or-later
"""Cameras of Blender as those of claray."""

import math
from dataclasses import dataclass

import claray
import numpy as np

from .geometry import turned


def frame_height(fit, width_of_sensor, height_of_sensor, width, height):
    """The height of the picture on the sensor over the sensor's size that the lens and the scale count for, and that size. fit: as of
    Camera.sensor_fit; width, height: of the picture."""
    horizontal = fit == "HORIZONTAL" or (fit == "AUTO" and width >= height)
    sensor = height_of_sensor if fit == "VERTICAL" else width_of_sensor
    return (height / width if horizontal else 1.0), sensor


@dataclass(frozen=True)
class Frame:
    """A picture whose middle is not that of the lens is a part of a larger one: width, height of the larger one, and where the part begins
    in it, from the left and from below. `grown`: the larger height over that of the part."""

    width: int
    height: int
    left: int
    low: int
    grown: float

    @classmethod
    def shifted(cls, width, height, right, up):
        """right, up: how far the picture's middle is from that of the lens, in pixels, rounded to whole ones."""
        right, up = round(right), round(up)
        tall = height + 2 * abs(up)
        return cls(width + 2 * abs(right), tall, abs(right) + right, abs(up) + up, tall / height)

    def cut(self, pixels, width, height):
        """The part of a picture, rows from the bottom."""
        return pixels[self.low:self.low + height, self.left:self.left + width]


def frame_of(camera, width, height, scale):
    """The Frame of a camera with a shift, which is in shares of the side that the sensor's fit names."""
    horizontal = camera.sensor_fit == "HORIZONTAL" or (camera.sensor_fit == "AUTO" and width * scale >= height)
    side = width if horizontal else height
    if camera.type == "PANO":
        return Frame(width, height, 0, 0, 1.0)
    return Frame.shifted(width, height, camera.shift_x * side, camera.shift_y * side)


def camera_of(thing, width, height, scale, grown, note):
    """A claray.Camera for a picture of this size. thing: the evaluated object. scale: width over height of a pixel. grown: of its Frame."""
    camera, matrix = thing.data, np.array(thing.matrix_world, np.float64)
    given = _pose(matrix)
    ratio, sensor = frame_height(camera.sensor_fit, camera.sensor_width, camera.sensor_height, width * scale, height)
    ratio *= grown
    if abs(scale - 1) > 1e-6:
        note("pixels that are not square are so")
    if camera.type == "PANO":
        if getattr(camera, "panorama_type", "") != "EQUIRECTANGULAR":
            note("a panorama other than equirectangular is so")
        return claray.Camera(projection="panorama", **given)
    if camera.type not in ("PERSP", "ORTHO"):
        note(f"a camera of the type {camera.type.lower()} is a perspective one")
    parallel = camera.type == "ORTHO"
    if camera.dof.use_dof:
        given.update(_lens(camera, matrix, parallel, note))
    if parallel:
        return claray.Camera(orthographic_height=camera.ortho_scale * ratio, **given)
    return claray.Camera(vertical_fov=2 * math.degrees(math.atan(sensor * ratio / 2 / camera.lens)), **given)


def _pose(matrix):
    position = turned(matrix[:3, 3])
    back, up = (turned(axis / np.linalg.norm(axis)) for axis in (matrix[:3, 2], matrix[:3, 1]))
    return {"position": position, "target": position - back, "up": up}


def _lens(camera, matrix, parallel, note):
    """The radius of the aperture is f / (2 N), of lenses in millimetres; orthographic ones have a focal length of 1 unit."""
    dof = camera.dof
    if dof.aperture_blades > 2 or abs(dof.aperture_ratio - 1) > 1e-3:
        note("the aperture is round")
    distance = dof.focus_distance
    if dof.focus_object:
        axis = matrix[:3, 2] / np.linalg.norm(matrix[:3, 2])
        distance = abs(float(axis @ (np.array(dof.focus_object.matrix_world)[:3, 3] - matrix[:3, 3])))
    focal = 1.0 if parallel else camera.lens * 1e-3
    return {"aperture_radius": focal / (2 * dof.aperture_fstop), "focus_distance": max(distance, 1e-4)}


def camera_of_view(view, width, height):
    """A claray.Camera for a 3D view of this size, and its Frame: through a camera the middle of the view may be elsewhere. view:
    RegionView3D, or what has its matrices."""
    given = _pose(np.array(view.view_matrix.inverted(), np.float64))
    window = np.array(view.window_matrix, np.float64)
    parallel = window[3, 3] == 1
    right, up = (-window[0, 3], -window[1, 3]) if parallel else (window[0, 2], window[1, 2])
    frame = Frame.shifted(width, height, right * width / 2, up * height / 2)
    if parallel:
        return claray.Camera(orthographic_height=2 / window[1, 1] * frame.grown, **given), frame
    return claray.Camera(vertical_fov=2 * math.degrees(math.atan(frame.grown / window[1, 1])), **given), frame
