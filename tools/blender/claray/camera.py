# SPDX-License-Identifier: GPL-3.0-or-later
"""Cameras of Blender as those of claray."""

import math

import claray
import numpy as np

from .geometry import turned


def frame_height(fit, width_of_sensor, height_of_sensor, width, height):
    """The height of the picture on the sensor over the sensor's size that the lens and the scale count for, and that size. fit: as of
    Camera.sensor_fit; width, height: of the picture."""
    horizontal = fit == "HORIZONTAL" or (fit == "AUTO" and width >= height)
    sensor = height_of_sensor if fit == "VERTICAL" else width_of_sensor
    return (height / width if horizontal else 1.0), sensor


def camera_of(thing, width, height, scale, note):
    """A claray.Camera for a picture of this size. thing: the evaluated object. scale: width over height of a pixel."""
    camera, matrix = thing.data, np.array(thing.matrix_world, np.float64)
    given = _pose(matrix)
    ratio, sensor = frame_height(camera.sensor_fit, camera.sensor_width, camera.sensor_height, width * scale, height)
    if camera.shift_x or camera.shift_y:
        note("the shift is left out")
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


def camera_of_view(view):
    """A claray.Camera for a 3D view. view: RegionView3D, or what has its matrices."""
    matrix = np.array(view.view_matrix.inverted(), np.float64)
    window = np.array(view.window_matrix, np.float64)
    given = _pose(matrix)
    if window[3, 3] == 1:  # parallel rays
        return claray.Camera(orthographic_height=2 / window[1, 1], **given)
    return claray.Camera(vertical_fov=2 * math.degrees(math.atan(1 / window[1, 1])), **given)
