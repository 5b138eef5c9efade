# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights and the world of Blender as those of claray.

A light of P watts (Blender's manual, Light Objects; tests/blender compares each with Cycles):
  point and spot  an intensity of P / (4 pi) W/sr; of a ball of radius r the radiance is P / (4 pi^2 r^2), its projected area times
                  which is that intensity
  area            a radiance of P / (pi A) from the front, of Lambertian emission
  sun             an irradiance of P W/m^2
"""

import math

import claray
import numpy as np

from .geometry import area_of, ball, disc, square, turned
from .materials import Shaders
from .nodes import Tree


def factor_of(light, note):
    """The colour times the exposure, the temperature and what an Emission node of the light says."""
    factor = np.array(light.color, np.float64) * 2.0 ** getattr(light, "exposure", 0.0)
    if getattr(light, "use_temperature", False):
        factor = factor * np.array(light.temperature_color)[:3]
    if light.use_nodes and light.node_tree:
        tree = Tree(light.node_tree, note, {})
        output = tree.output("ShaderNodeOutputLight")
        surface = Shaders(tree).at(output.inputs["Surface"]) if output else None
        if surface is None:
            return factor * 0
        if not surface.emission.is_constant:
            note("the image of a light counts with its mean")
        factor = factor * surface.strength * surface.emission.mean()[:3]
    if light.diffuse_factor != 1 or light.specular_factor != 1 or light.transmission_factor != 1:
        note("factors for diffuse, glossy and transmitted light are left out")
    if not light.use_shadow:
        note("lights without shadows have some")
    return factor


class Lamps:
    """Adds lights to a claray.Scene. Those with an extent are meshes; their instances are in `instances`: mesh, matrix, name."""

    def __init__(self, scene, report):
        self._scene, self._report = scene, report
        self.instances = []
        self.seen = []  # places of what rays of the camera meet, with names

    def add(self, thing, matrix):
        """thing: the evaluated object; matrix: (4, 4), of the world."""
        light, name = thing.data, thing.name

        def note(text):
            self._report.note(f"light '{name}'", text)
        factor = factor_of(light, note)
        if (factor < 0).any() or light.energy < 0:
            note("light that is taken away is left out")
            return
        power = light.energy * factor
        if not power.any():
            return
        getattr(self, "_" + light.type.lower())(light, name, matrix, power, note)

    def _sun(self, light, name, matrix, power, note):
        half = min(light.angle / 2, math.pi / 2)
        direction = _direction(matrix)
        if half < 1e-4:
            self._scene.add_light(kind="directional", name=name, direction=direction, intensity=power)
        else:
            self._scene.add_light(kind="sun", name=name, direction=direction, intensity=power, outer_angle=half)

    def _point(self, light, name, matrix, power, note):
        radius = light.shadow_soft_size
        position = turned(matrix[:3, 3])
        if radius <= 0:
            self._scene.add_light(kind="point", name=name, position=position, intensity=power / (4 * math.pi))
            return
        points, triangles = ball()
        # Of a convex body the mean of the projected areas is a quarter of its surface (Cauchy); this ball of triangles has that of a ball.
        points = points * (4 * math.pi / area_of(points, triangles)) ** 0.5
        radiance = power / (4 * math.pi ** 2 * (radius ** 2 if _normalized(light) else 1))
        placed = np.eye(4)
        placed[:3, :3], placed[:3, 3] = np.eye(3) * radius, matrix[:3, 3]
        self._add_mesh(name, points, triangles, radiance, placed, False)

    def _spot(self, light, name, matrix, power, note):
        if light.shadow_soft_size > 0:
            note("a spot has no radius, so that its shadows are sharp")
        if light.use_square:
            note("a square spot is round")
        outer = min(light.spot_size / 2, math.pi / 2 - 1e-4)
        # Cycles fades by a smooth step over the cosines of the share `blend` of the cone; claray by the square of a linear one (glTF).
        # Three quarters of the width hold the same power.
        edge = math.cos(outer)
        inner = math.acos(min(1.0, edge + 0.75 * (1 - edge) * light.spot_blend))
        self._scene.add_light(kind="spot", name=name, position=turned(matrix[:3, 3]), direction=_direction(matrix),
                              intensity=power / (4 * math.pi), inner_angle=min(inner, outer * 0.9999), outer_angle=outer)

    def _area(self, light, name, matrix, power, note):
        round_one = light.shape in ("DISK", "ELLIPSE")
        points, triangles = disc() if round_one else square()
        height = light.size_y if light.shape in ("RECTANGLE", "ELLIPSE") else light.size
        points = points * [light.size / 2, height / 2, 1]
        if round_one:  # with as much area as the circle
            points = points * (math.pi / area_of(*disc())) ** 0.5
        if light.spread < math.pi - 1e-3:
            note("an area light shines to all sides, without a spread")
        world = points @ matrix[:3, :3].T + matrix[:3, 3]
        area = area_of(world, triangles)
        if area <= 0:
            note("an area light of size 0 is left out")
            return
        self._add_mesh(name, points, triangles, power / (math.pi * (area if _normalized(light) else 1)), matrix, True)

    def _add_mesh(self, name, points, triangles, radiance, matrix, one_sided):
        material = self._scene.add_material(name=name, kind="lambert", albedo=(0, 0, 0), emission=radiance, cull_back=one_sided)
        self.instances.append((self._scene.add_mesh(points, triangles, material=material, name=name), matrix, name))
        self.seen.append((name, matrix[:3, 3], -matrix[:3, 2] if one_sided else None))


def _normalized(light):
    return getattr(light, "normalize", True)


def _direction(matrix):
    axis = turned(-np.asarray(matrix)[:3, 2])
    return axis / np.linalg.norm(axis)


def add_world(scene, world, report):
    """Gives the scene the surroundings of a world of Blender."""
    if world is None:
        return

    def note(text):
        report.note(f"world '{world.name}'", text)
    if not world.use_nodes or world.node_tree is None:
        scene.sky = tuple(np.maximum(world.color, 0))
        return
    tree = Tree(world.node_tree, note, {})
    output = tree.output("ShaderNodeOutputWorld")
    if output is None:
        return
    if tree.source(output.inputs["Volume"])[0] is not None:
        note("a volume is left out")
    surface = Shaders(tree).at(output.inputs["Surface"])
    if surface is None or surface.strength <= 0:
        return
    if surface.emission.is_constant:
        scene.sky = tuple(np.maximum(surface.strength * surface.emission.data[:3], 0).tolist())
        return
    texels = np.maximum(np.nan_to_num(surface.emission.data[..., :3], posinf=65504.0), 0)
    # The middle of Blender's image is towards +x, that of claray's towards -z: a quarter turn clockwise from above. A Mapping node turns
    # directions before they are looked up, and so the image the other way.
    scene.environment = claray.Environment(claray.Texture(texels, "linear"), surface.strength, -math.pi / 2 - surface.emission.place.rotation)
