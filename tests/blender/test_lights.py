"""Lights have the units of Blender: means within 2 % of those of Cycles, and closed forms."""

import math

import numpy as np
import pytest
import support

def means_agree(scene, samples=32, samples_of_cycles=64, share=0.02):
    ours, cycles = support.both(scene, samples, samples_of_cycles)
    np.testing.assert_allclose(ours.mean((0, 1)), cycles.mean((0, 1)), rtol=share)
    return ours, cycles


@pytest.mark.parametrize("name", support.LAMPS)
def test_lamp_as_bright_as_in_cycles(name):
    scene = support.empty_scene()
    support.below_lamp(scene, name)
    means_agree(scene)
    assert not [line for line in support.lines(scene) if "energy" in line]


def test_closed_forms():
    """A white surface below a light shows its irradiance over pi."""
    for kind, values, irradiance in (("POINT", dict(energy=100, shadow_soft_size=0), 100 / (4 * math.pi) / 25),
                                     ("SPOT", dict(energy=100, shadow_soft_size=0), 100 / (4 * math.pi) / 25),
                                     ("SUN", dict(energy=2, angle=0), 2)):
        scene = support.empty_scene()
        support.add_plane(scene, support.diffuse((1, 1, 1)), 0.5)
        support.add_light(scene, kind, (0, 0, 5), **values)
        scene.claray.max_depth = 1
        ours = support.picture(scene, "CLARAY", 1)
        assert ours[24, 32, 0] == pytest.approx(irradiance / math.pi, rel=1e-3)


def test_lamp_of_a_size_of_its_own():
    """`normalize` off: the power is that of each unit of area."""
    scene = support.empty_scene()
    support.add_plane(scene, support.diffuse((0.8, 0.8, 0.8)), 6)
    lamp = support.add_light(scene, "AREA", (0, 0, 4.5), energy=100, size=0.5)
    if not hasattr(lamp.data, "normalize"):
        pytest.skip("this Blender has no Light.normalize")
    lamp.data.normalize = False
    means_agree(scene)


def test_emissive_mesh_and_world():
    scene = support.empty_scene()
    support.add_plane(scene, support.diffuse((0.7, 0.7, 0.7)), 8)
    support.add_box(scene, (-1, -1, 0.5), (0, 0, 1), support.emission((1, 0.7, 0.4), 3))
    support.set_world(scene, (0.2, 0.3, 0.5), 1.5)
    means_agree(scene, 64)


@pytest.mark.parametrize("turn", [0.0, 1.0])
def test_image_of_the_world(turn):
    """An image with one bright quarter lights a ball from the same side as in Cycles."""
    scene = support.empty_scene()
    support.below_image(scene, turn)
    ours, cycles = means_agree(scene, 64)
    assert np.abs(ours - cycles).mean() < 0.06 * cycles.mean()
    assert support.lines(scene) == []


def test_lamps_that_the_camera_sees_are_told():
    scene = support.empty_scene()
    support.add_light(scene, "POINT", (0, 0, 0), energy=10, shadow_soft_size=0.1)
    support.picture(scene, "CLARAY", 1)
    assert support.lines(scene) == ["light 'lamp': is seen by the camera, which Blender hides from it"]
