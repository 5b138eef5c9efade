"""Scenes of five kinds that people bring as glTF: textured materials of metal and roughness, glass, many lamps, cut-out leaves.

They have the form of scenes.py, but their parts are those of gltf.py.
"""
import numpy as np

from meshes import ball, box, lathe, merged, quad


def gltf(color=(1, 1, 1), metallic=0.0, roughness=0.8, **more):
    return dict(kind="gltf", color=color, metallic=metallic, roughness=roughness, **more)


def lamp(x, y, z, half, color):
    """A lamp that faces down, below a black box which it closes: Cycles' lamps emit on both sides."""
    black = dict(kind="diffuse", color=(0, 0, 0))
    return [(quad((x, y, z), (half, 0, 0), (0, 0, half)), dict(kind="lamp", color=color)),
            (box((x, y + .1 * half, z), (half, .1 * half, half), bottom=False), black)]


def boards(seed, side=256):
    v, u = np.mgrid[0:side, 0:side] / side
    tone = np.repeat(np.random.default_rng(seed).uniform(.5, 1, 8), side // 8)[:, None] * (.85 + .15 * np.sin(40 * u + 9 * np.sin(6 * v)))
    return np.clip(255 * tone[..., None] * [.75, .55, .4], 0, 255).astype(np.uint8)


def bricks(side=256):
    v, u = np.mgrid[0:side, 0:side] / side
    row = np.floor(v * 8)
    column = u * 4 + .5 * (row % 2)
    mortar = ((v * 8 % 1) < .12) | ((column % 1) < .06)
    tone = .8 + .2 * np.sin(np.floor(column) * 12.9 + row * 78.2)
    return np.where(mortar[..., None], [190, 185, 180], np.clip(tone[..., None] * [200, 150, 130], 0, 255)).astype(np.uint8)


def textured_room():
    """Lit by the sky through a window."""
    wall, white = gltf(texture=bricks(), roughness=.9), gltf((.8, .8, .8), roughness=.9)
    walls = [((0, 1, -2), (2, 0, 0), (0, 1, 0)), ((2, 1, 0), (0, 0, 2), (0, 1, 0)), ((0, 1, 2), (-2, 0, 0), (0, 1, 0)),
             ((-2, .35, 0), (0, 0, -2), (0, .35, 0)), ((-2, 1.8, 0), (0, 0, -2), (0, .2, 0)), ((-2, 1.15, -1.4), (0, 0, -.6), (0, .45, 0)),
             ((-2, 1.15, 1.4), (0, 0, -.6), (0, .45, 0))]
    parts = [(quad((0, 0, 0), (2, 0, 0), (0, 0, -2)), gltf(texture=boards(0), roughness=.5)), (quad((0, 2, 0), (2, 0, 0), (0, 0, 2)), white)]
    parts += [(quad(*w), wall) for w in walls]
    parts += [(box((.4, .4, -.6), (.5, .4, .3), .4), gltf(texture=boards(2), roughness=.4)), (ball((-.6, .35, .2), .35), gltf((.7, .2, .2), roughness=.3))]
    return dict(parts=parts, eye=(1.7, 1.1, 1.7), target=(-.5, .6, -.6), fov=60, depth=8, sky=(2, 2.2, 2.6))


def bottle(x, z, radius, height, thickness=.03):
    """The outline from the middle of the bottom, up the outside, over the lip, and down the inside."""
    def width(y):
        return radius * np.where(y < .6, 1, .35 + .65 * (.5 + .5 * np.cos(np.pi * np.clip((y - .6) / .2, 0, 1))))

    y, r = np.linspace(0, 1, 40), np.linspace(0, .95, 12)
    angle = np.linspace(0, np.pi, 7)[1:-1]
    outside = np.stack([width(y), .02 + y * (height - .02)], 1)
    inside = np.stack([width(y) - thickness, .02 + thickness + y * (height - .02 - thickness)], 1)[::-1]
    lip = outside[-1] + .5 * thickness * np.stack([np.cos(angle) - 1, np.sin(angle)], 1)
    bottom, floor = np.stack([r * radius, .01 * (1 - (1 - r) ** 2)], 1), np.stack([r[::-1] * (radius - thickness), np.full(12, .02 + thickness)], 1)
    return lathe(np.concatenate([bottom, outside, lip, inside, floor]), np.array((x, .001, z)))


def bottles():
    """Their caustics are of a small lamp."""
    places = [(-.8, 0, .22, 1.1), (-.2, -.3, .25, .9), (.35, .1, .2, 1.2), (.95, -.2, .24, .8)]
    parts = [(quad((0, 0, 0), (2, 0, 0), (0, 0, -2)), gltf((.7, .7, .7), roughness=.9)),
             (quad((0, 1, -1.2), (2, 0, 0), (0, 1, 0)), gltf((.6, .6, .7), roughness=.9)),
             *((bottle(*place), dict(kind="glass")) for place in places), *lamp(-1, 2.5, 1, .2, (60, 55, 50))]
    return dict(parts=parts, eye=(.3, 1.1, 3.6), target=(0, .5, 0), fov=38, depth=16, sky=(.1, .12, .15))


def sunny_sky(height=512):
    y, x = np.meshgrid((np.arange(height) + .5) / height * np.pi, (np.arange(2 * height) + .5) / height * np.pi, indexing="ij")
    image = np.where(y[..., None] < np.pi / 2, (.3, .4, .6), (.12, .1, .08)) + .15 * (1 + np.sin(7 * x) * np.sin(5 * y))[..., None]
    return image + np.exp(-((y - .8) / .015) ** 2 - ((x - 2) / .015) ** 2)[..., None] * (3000, 2850, 2400)


def metals():
    """Balls under an image with a sun."""
    colors, roughness = ((1, .77, .34), (.95, .64, .54), (.91, .92, .92), (.56, .57, .58)), (.08, .15, .25, .35, .5, .7)
    parts = [(quad((0, 0, 0), (5, 0, 0), (0, 0, -5)), gltf((.5, .5, .5), roughness=.9))]
    parts += [(ball((1.05 * (k % 4 - 1.5), .5, 1.1 * (k // 4 - 1)), .5, 64), gltf(colors[k % 4], 1.0, roughness[k % 6])) for k in range(12)]
    return dict(parts=parts, eye=(2.5, 3, 5), target=(0, .3, 0), fov=42, depth=8, environment=sunny_sky())


def lamps():
    """240 of them, whose radiances span two and a half decades."""
    rng = np.random.default_rng(4)
    grey = gltf((.6, .6, .6))
    parts = [(quad((0, 0, 0), (6, 0, 0), (0, 0, -6)), grey), (quad((0, 3, 0), (6, 0, 0), (0, 0, 6)), grey),
             (quad((0, 1.5, -6), (6, 0, 0), (0, 1.5, 0)), grey), (quad((-6, 1.5, 0), (0, 0, -6), (0, 1.5, 0)), gltf((.6, .3, .3))),
             (quad((6, 1.5, 0), (0, 0, 6), (0, 1.5, 0)), gltf((.3, .6, .3)))]
    for _ in range(24):
        place, turn = (rng.uniform(-5, 5), .5, rng.uniform(-5, 4)), rng.uniform(0, 3)
        parts.append((box(place, (.3, .5, .3), turn), gltf(tuple(rng.uniform(.2, .8, 3).tolist()), roughness=.5)))
    for _ in range(240):
        x, z, y = rng.uniform(-5.8, 5.8), rng.uniform(-5.8, 5.8), rng.uniform(1.2, 2.9)
        color = 10 ** rng.uniform(-.5, 2) * rng.uniform(.5, 1, 3)
        parts += lamp(x, y, z, .05, tuple(color.tolist()))
    return dict(parts=parts, eye=(0, 1.6, 5.9), target=(0, 1, 0), fov=60, depth=8)


def leaves():
    """A tree of 900 cut-outs under the sun and the sky."""
    rng = np.random.default_rng(5)
    v, u = np.mgrid[0:64, 0:64] / 64
    mask = np.where(np.abs(u - .5) < .45 * np.sin(np.pi * v) * (.8 + .2 * np.cos(30 * v)), 255, 0).astype(np.uint8)
    shapes = []
    for _ in range(900):
        center = rng.normal((0, 1.6, 0), (.8, .5, .8))
        along = rng.normal(size=3)
        across = np.cross(along, rng.normal(size=3))
        shapes.append(quad(center, .12 * along / np.linalg.norm(along), .12 * across / np.linalg.norm(across)))
    parts = [(quad((0, 0, 0), (4, 0, 0), (0, 0, -4)), gltf((.5, .4, .3), roughness=.9)), (merged(*shapes), gltf((.2, .5, .15), roughness=.6, mask=mask)),
             (box((0, .6, 0), (.08, .6, .08)), gltf((.4, .3, .2)))]
    light = dict(kind="directional", direction=(-.5, -1, -.4), color=(4, 3.8, 3.3))
    return dict(parts=parts, eye=(0, 1.8, 5), target=(0, 1.2, 0), fov=42, depth=8, sky=(.4, .5, .7), light=light)


def all_scenes():
    """Functions that make them."""
    return {"textured-room": textured_room, "bottles": bottles, "metals": metals, "lamps": lamps, "leaves": leaves}
