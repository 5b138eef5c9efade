# SPDX-License-Identifier: GPL-3.0-or-later
"""A claray.Scene of what Blender's dependency graph shows."""

from collections import Counter

import bpy
import claray
import numpy as np

from .geometry import AXES, arrays_of
from .lights import Lamps, add_world
from .materials import Materials
from .report import Report

MESHES = ("MESH", "CURVE", "SURFACE", "META", "FONT")
MOST_COPIED = 2**19  # triangles
LEAST_OF_A_COPY = 64  # triangles that the fixed time of a mesh is worth
LEFT_OUT = {"VOLUME": "volumes", "CURVES": "hair curves", "POINTCLOUD": "point clouds", "GREASEPENCIL": "Grease Pencil"}


class _Meshes:
    """The meshes of a claray.Scene: one for each of Blender's with the same materials."""

    def __init__(self, scene, materials, report):
        self._scene, self._materials, self._report = scene, materials, report
        self._numbers, self._arrays = {}, {}

    def number(self, thing):
        """The number of the mesh of an evaluated object; None: it has no faces."""
        slots = [slot.material for slot in thing.material_slots] or [None]
        data = thing.data.as_pointer() if thing.type == "MESH" else thing.original.session_uid
        key = (data, *(0 if one is None else one.original.session_uid for one in slots))
        if key not in self._numbers:
            self._numbers[key] = self._add(thing, [self._materials.number(one) for one in slots])
        return self._numbers[key]

    def _add(self, thing, numbers):
        uv_maps, color = self._needs(thing, numbers)
        if thing.type == "MESH":
            return self._add_arrays(thing, arrays_of(thing.data, uv_maps, color), numbers, uv_maps)
        try:
            return self._add_arrays(thing, arrays_of(thing.to_mesh(), uv_maps, color), numbers, uv_maps)
        finally:
            thing.to_mesh_clear()

    def _needs(self, thing, numbers):
        """The names of the UV maps and of the vertex colours that the materials read."""
        uv_maps, color = [], None
        for number in numbers:
            for i, name in enumerate(self._materials.uv_maps[number]):
                if i == len(uv_maps):
                    uv_maps.append(name)
                elif uv_maps[i] != name:
                    self._report.note(f"object '{thing.name}'", f"materials that use different UV maps; '{uv_maps[i]}' is used for all")
            color = color if self._materials.vertex_colors[number] is None else self._materials.vertex_colors[number]
        return uv_maps, color

    def _add_arrays(self, thing, made, numbers, uv_maps):
        if made is None:
            return None
        if uv_maps and "uvs" not in made:
            self._report.note(f"object '{thing.name}'", "has textures, but not their UV map; they show one texel")
            made["uvs"] = np.zeros((len(made["vertices"]), 2), np.float32)
        slots = np.clip(made.pop("slots"), 0, len(numbers) - 1)
        made.update(material=numbers[0] if len(numbers) == 1 else np.array(numbers)[slots], name=thing.name)
        number = self._scene.add_mesh(**made)
        if len(made["triangles"]) <= MOST_COPIED:
            self._arrays[number] = made
        return number

    def separate(self, numbers, most):
        """The numbers of the meshes of all instances, of which those of small meshes get meshes of their own: claray puts meshes with one
        instance into one tree, through which rays are faster than through instances. most: triangles of all copies together."""
        uses, copied = Counter(numbers), set()
        cost = {number: (uses[number] - 1) * max(len(made["triangles"]), LEAST_OF_A_COPY) for number, made in self._arrays.items()}
        for number in sorted(cost, key=cost.get):
            most -= cost[number]
            if most < 0:
                break
            copied.add(number)
        first, own = set(), []
        for number in numbers:
            own.append(self._scene.add_mesh(**self._arrays[number]) if number in copied and number in first else number)
            first.add(number)
        return own


def _note_settings(scene, report):
    render = scene.render
    for used, text in ((render.use_motion_blur, "motion blur is left out"),
                       (render.film_transparent, "the background is not transparent"),
                       (getattr(render, "use_multiview", False), "stereoscopy is left out"),
                       (render.use_freestyle, "Freestyle's lines are left out")):
        if used:
            report.note("scene", text)
    space = getattr(getattr(bpy.data, "colorspace", None), "working_space", "Linear Rec.709")
    if space != "Linear Rec.709":
        report.note("scene", f"colours of the working space '{space}' count as linear Rec. 709")


def _note_object(thing, report):
    for used, text in ((thing.is_holdout, "is a holdout, and is shown"), (thing.is_shadow_catcher, "is a shadow catcher, and is shown"),
                       (not all((thing.visible_camera, thing.visible_diffuse, thing.visible_glossy, thing.visible_transmission,
                                 thing.visible_shadow)), "is hidden from some rays, and is shown to all")):
        if used:
            report.note(f"object '{thing.name}'", text)
    for system in thing.particle_systems:
        if system.settings.type == "HAIR" and system.settings.render_type == "PATH":
            report.note(f"object '{thing.name}'", "the hair of particles is left out")


def scene_of(depsgraph, most_copied=MOST_COPIED):
    """The scene without a camera, the Report of what is left out, and the lamps that rays of the camera may meet. most_copied: as `most` of
    _Meshes.separate."""
    scene, report = claray.Scene(), Report()
    materials, lamps = Materials(scene, report), Lamps(scene, report)
    meshes = _Meshes(scene, materials, report)
    numbers, matrices, names = [], [], []
    _note_settings(depsgraph.scene, report)
    noted = set()
    for instance in depsgraph.object_instances:
        thing = instance.object
        if not instance.show_self:
            continue
        matrix = np.array(instance.matrix_world, np.float64)
        if thing.type == "LIGHT":
            lamps.add(thing, matrix)
        elif thing.type in LEFT_OUT:
            report.note(f"object '{thing.name}'", f"{LEFT_OUT[thing.type]} are left out")
        elif thing.type in MESHES:
            if thing.original.session_uid not in noted:
                noted.add(thing.original.session_uid)
                _note_object(thing, report)
            number = meshes.number(thing)
            if number is None:
                continue
            if abs(np.linalg.det(matrix[:3, :3])) < 1e-30:
                report.note(f"object '{thing.name}'", "is flat by a scale of 0, and is left out")
                continue
            numbers.append(number)
            matrices.append(AXES @ matrix)
            names.append(thing.name)
    for number, matrix, name in lamps.instances:
        numbers.append(number)
        matrices.append(AXES @ matrix)
        names.append(name)
    if numbers:
        scene.set_instances(meshes.separate(numbers, most_copied), np.array(matrices), names=names)
    add_world(scene, depsgraph.scene.world, report)
    return scene, report, lamps.seen


def note_seen_lamps(seen, camera, aspect, report):
    """Notes the lamps that the camera sees, which Blender hides from it."""
    position, target, up = (np.array(v) for v in (camera.position, camera.target, camera.up))
    forward = target - position
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, up)
    right /= np.linalg.norm(right)
    above = np.cross(right, forward)
    for name, place, axis in seen:
        to = AXES[:3, :3] @ place - position
        if axis is not None and (AXES[:3, :3] @ axis) @ to >= 0:
            continue  # its back, which is not seen
        if camera.projection == "panorama":
            inside = True
        elif camera.projection == "orthographic":
            half = camera.orthographic_height / 2
            inside = to @ forward > 0 and abs(to @ above) < half and abs(to @ right) < half * aspect
        else:
            half = np.tan(np.radians(camera.vertical_fov) / 2) * (to @ forward)
            inside = to @ forward > 0 and abs(to @ above) < half and abs(to @ right) < half * aspect
        if inside:
            report.note(f"light '{name}'", "is seen by the camera, which Blender hides from it")
