"""Scenes that claray, Mitsuba and Cycles describe in the same way; y is up.

A scene has `parts`, tuples of (positions, triangles), (kind of material, values) and, where it is smooth, normals of the vertices. Lamps
emit on one side: their back is inside a closed black box, since lamps of claray and of Cycles emit on both sides.
"""
import numpy as np

# ---- shapes: (positions, triangles); materials: (kind, values)


def quad(center, u, v):
    center, u, v = (np.array(x, float) for x in (center, u, v))
    return np.array([center - u - v, center + u - v, center + u + v, center - u + v]), np.array([[0, 1, 2], [0, 2, 3]])


def merged(*parts):
    starts = np.cumsum([0] + [len(p) for p, _ in parts])
    return np.concatenate([p for p, _ in parts]), np.concatenate([t + n for (_, t), n in zip(parts, starts)])


def sides_of_box(center, half, turn, bottom):
    """Arguments of quads: their centers and half edges."""
    s, c = np.sin(turn), np.cos(turn)
    x, y, z = np.array([c, 0, -s]) * half[0], np.array([0, half[1], 0.0]), np.array([s, 0, c]) * half[2]
    m = np.array(center, float)
    return [(m + x, y, z), (m - x, z, y), (m + y, z, x), (m + z, x, y), (m - z, y, x), *([(m - y, x, z)] if bottom else [])]


def box(center, half, turn=0.0, bottom=True):
    return merged(*(quad(*side) for side in sides_of_box(center, half, turn, bottom)))


def ball(center, radius, rows):
    theta, phi = np.meshgrid(np.linspace(0, np.pi, rows + 1), np.linspace(0, 2 * np.pi, 2 * rows + 1), indexing="ij")
    n = np.stack([np.sin(theta) * np.sin(phi), np.cos(theta), np.sin(theta) * np.cos(phi)], -1).reshape(-1, 3)
    a = (np.arange(rows)[:, None] * (2 * rows + 1) + np.arange(2 * rows)[None]).reshape(-1)
    b = a + 2 * rows + 1
    t, p = np.concatenate([np.stack([a, b, b + 1], -1), np.stack([a, b + 1, a + 1], -1)]), np.array(center) + radius * n
    area = np.linalg.norm(np.cross(p[t[:, 1]] - p[t[:, 0]], p[t[:, 2]] - p[t[:, 0]]), axis=1)
    return p, t[area > 1e-12]


def smooth_ball(center, radius, rows, material):
    """A part with vertex normals."""
    p, t = ball(center, radius, rows)
    return (p, t), material, (p - np.array(center)) / radius


def diffuse(*color):
    return "diffuse", color


def lamp(x, z, half, color, y=1.98):
    """A lamp that faces down, below a black box which it closes."""
    return [(quad((x, y, z), (half, 0, 0), (0, 0, half)), ("lamp", color)),
            (box((x, y + 0.005, z), (half, 0.005, half), bottom=False), diffuse(0, 0, 0))]


def room(w, h, d):
    """Open towards +z."""
    return [(quad((0, 0, 0), (w, 0, 0), (0, 0, -d)), diffuse(.7, .7, .7)), (quad((0, 2 * h, 0), (w, 0, 0), (0, 0, d)), diffuse(.7, .7, .7)),
            (quad((0, h, -d), (w, 0, 0), (0, h, 0)), diffuse(.7, .7, .7)), (quad((-w, h, 0), (0, 0, -d), (0, h, 0)), diffuse(.6, .1, .1)),
            (quad((w, h, 0), (0, 0, d), (0, h, 0)), diffuse(.1, .5, .1))]


def cornell():
    parts = [(box((-.35, .6, -.3), (.3, .6, .3), .3), diffuse(.7, .7, .7)), (box((.35, .3, .35), (.3, .3, .3), -.3), diffuse(.7, .7, .7))]
    return dict(parts=room(1, 1, 1) + parts + lamp(0, 0, .25, (15, 15, 15)), eye=(0, 1, 3.9), target=(0, 1, 0), fov=39, depth=8)


def hall():
    rng = np.random.default_rng(3)
    parts = room(3, 1, 3)
    for _ in range(10):
        parts.append((box((rng.uniform(-2.5, 2.5), .4, rng.uniform(-2.5, 2)), (.2, .4, .2), rng.uniform(0, 3)), diffuse(*rng.uniform(.3, .8, 3))))
    for i in range(16):
        parts += lamp(-2.2 + 1.5 * (i % 4), -2.2 + 1.3 * (i // 4), .1 + .05 * (i % 3), tuple(rng.uniform(5, 20, 3)), y=1.95)
    return dict(parts=parts, eye=(0, 1, 6.5), target=(0, .9, 0), fov=45, depth=8)


def glass():
    parts = [(ball((0, .5, .1), .45, 360), ("glass", 1.5))]
    return dict(parts=room(1, 1, 1) + parts + lamp(0, 0, .25, (15, 15, 15)), eye=(0, 1, 3.9), target=(0, 1, 0), fov=39, depth=12)


def window():
    """A room lit by the sky through a window."""
    white, floor = diffuse(.8, .8, .8), diffuse(.5, .4, .3)
    walls = [((0, 0, 0), (2, 0, 0), (0, 0, -2), floor), ((0, 2, 0), (2, 0, 0), (0, 0, 2), white), ((0, 1, -2), (2, 0, 0), (0, 1, 0), white),
             ((2, 1, 0), (0, 0, 2), (0, 1, 0), white), ((0, 1, 2), (2, 0, 0), (0, 1, 0), white), ((-2, .35, 0), (0, 0, -2), (0, .35, 0), white),
             ((-2, 1.8, 0), (0, 0, -2), (0, .2, 0), white), ((-2, 1.15, -1.4), (0, 0, -.6), (0, .45, 0), white),
             ((-2, 1.15, 1.4), (0, 0, -.6), (0, .45, 0), white)]
    parts = [(quad(c, u, v), m) for c, u, v, m in walls] + [(ball((.3, .5, -.5), .5, 48), diffuse(.6, .6, .7))]
    return dict(parts=parts, eye=(1.7, 1.1, 1.7), target=(-.5, .6, -.6), fov=60, depth=8, sky=(2, 2.2, 2.6))


def studio():
    """Smooth spheres under an environment with a small sun."""
    height, width = 1024, 2048
    y, x = np.meshgrid((np.arange(height) + .5) / height * np.pi, (np.arange(width) + .5) / width * 2 * np.pi, indexing="ij")
    image = np.where(y[..., None] < np.pi / 2, (.3, .4, .6), (.1, .09, .08)) + .1 * (1 + np.sin(7 * x) * np.sin(5 * y))[..., None]
    image += np.exp(-((y - .7) / .03) ** 2 - ((x - 2) / .03) ** 2)[..., None] * (400, 380, 300)
    rng = np.random.default_rng(1)
    parts = [smooth_ball((1.1 * (k % 3 - 1), .5, 1.1 * (k // 3 - 1)), .5, 64, diffuse(*rng.uniform(.2, .9, 3))) for k in range(9)]
    parts.append((quad((0, 0, 0), (8, 0, 0), (0, 0, -8)), diffuse(.5, .5, .5)))
    return dict(parts=parts, eye=(3, 2.5, 5), target=(0, .4, 0), fov=40, depth=8, environment=image)


def sponza(path):
    positions, triangles = [], []
    for line in open(path):
        words = line.split()
        if words[:1] == ["v"]:
            positions.append([float(x) for x in words[1:4]])
        elif words[:1] == ["f"]:
            face = [int(x.split("/")[0]) for x in words[1:]]
            face = [x - 1 if x > 0 else len(positions) + x for x in face]
            triangles += [[face[0], face[k], face[k + 1]] for k in range(1, len(face) - 1)]
    p, t = np.array(positions), np.array(triangles)
    low, high = p.min(0), p.max(0)
    middle, side = (low + high) / 2, (high - low).max()
    return dict(parts=[((p, t), diffuse(.7, .7, .7))], eye=tuple(middle + side * np.array([-.33, -.11, .01])),
                target=tuple(middle + side * np.array([.2, -.06, -.06])), fov=75, depth=5, sky=(.5, .5, .5))


def all_scenes(sponza_file=None):
    """Functions that make them."""
    made = dict(cornell=cornell, hall=hall, glass=glass, window=window, studio=studio)
    return dict(made, sponza=lambda: sponza(sponza_file)) if sponza_file else made


# ---- files

def write_obj(scene, path):
    lines, materials, base, base_of_normals = [f"mtllib {path.stem}.mtl"], [], 1, 1
    for k, ((p, t), (kind, values), *normals) in enumerate(scene["parts"]):
        lines += [f"o p{k}", f"usemtl m{k}"] + ["v %.9g %.9g %.9g" % tuple(x) for x in p]
        lines += ["vn %.9g %.9g %.9g" % tuple(x) for n in normals for x in n]
        corner = "{0}//{1}" if normals else "{0}"
        lines += ["f " + " ".join(corner.format(i + base, i + base_of_normals) for i in x) for x in t]
        base, base_of_normals = base + len(p), base_of_normals + (len(p) if normals else 0)
        materials += [f"newmtl m{k}"] + {"diffuse": lambda: ["Kd %g %g %g" % values], "lamp": lambda: ["Kd 0 0 0", "Ke %g %g %g" % values],
                                         "glass": lambda: ["Kd 0 0 0", "Ks 1 1 1", "Ni %g" % values, "Tf 1 1 1", "illum 7"]}[kind]()
    path.write_text("\n".join(lines) + "\n")
    path.with_suffix(".mtl").write_text("\n".join(materials) + "\n")


def write_pfm(image, path):
    path.write_bytes(b"PF\n%d %d\n-1.0\n" % (image.shape[1], image.shape[0]) + image[::-1].astype("<f4").tobytes())


def read_pfm(path):
    """Rows from the top."""
    with open(path, "rb") as file:
        assert file.readline().strip() == b"PF"
        width, height = map(int, file.readline().split())
        file.readline()
        return np.frombuffer(file.read(), "<f4").reshape(height, width, 3)[::-1].astype(float)
