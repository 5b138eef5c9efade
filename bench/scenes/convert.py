#!/usr/bin/env python3
"""Scenes that no kernel was tuned for: reads them from checkouts of their public repositories, writes them for bench_peers.

    convert.py REPOSITORIES OUTPUT [--set training | "held out"]
    convert.py --file SCENE OUTPUT.scn

REPOSITORIES holds one checkout per repository of sources.json, named OWNER+NAME, as made by
`git clone https://github.com/OWNER/NAME OWNER+NAME`. Scenes whose files are missing are skipped with a line that says so. The second form
converts one file of yours: PLY, OBJ, glTF, or a pbrt-v3 scene that consists of `Shape "plymesh"`.

OUTPUT gets a NAME.scn per scene: the words 'SCN1', vertices, triangles, 0; positions as float32; indices as uint32 (see
host/measure/rays.hpp). Needs numpy and trimesh (PyPI).
"""

import argparse
import json
import pathlib
import re
import sys

import numpy
import trimesh


def read_triangles(path):
    """The triangles of a mesh file, instances in place: positions (n, 3) and indices (m, 3)."""
    mesh = trimesh.load(path, process=False, force="mesh", skip_materials=True)
    return numpy.asarray(mesh.vertices), numpy.asarray(mesh.faces)


def matrix(text):
    """A pbrt matrix: 16 numbers, column by column."""
    return numpy.array([float(number) for number in text.split()]).reshape(4, 4).T


# What changes the place of a shape, and the shapes. Everything else is skipped.
PBRT = re.compile(r'\b(WorldBegin|AttributeBegin|AttributeEnd|TransformBegin|TransformEnd|Identity)\b|'
                  r'\b(Transform|ConcatTransform)\s*\[([^]]*)\]|'
                  r'Shape\s+"plymesh"\s+"string filename"\s*\[\s*"([^"]+)"\s*\]')


def read_pbrt(path):
    """The PLY meshes of a pbrt-v3 scene, placed."""
    parts, stack, place = [], [], numpy.eye(4)
    for word, transform, numbers, file in PBRT.findall(path.read_text()):
        if word in ("WorldBegin", "Identity"):
            place = numpy.eye(4)
        elif word.endswith("Begin"):
            stack.append(place)
        elif word:
            place = stack.pop()
        elif transform:
            place = matrix(numbers) if transform == "Transform" else place @ matrix(numbers)
        else:
            if not (path.parent / file).exists():
                print(f"{path}: {file} is missing; the scene goes on without it", file=sys.stderr)
                continue
            positions, indices = read_triangles(path.parent / file)
            parts.append((positions @ place[:3, :3].T + place[:3, 3], indices))
    if not parts:
        raise ValueError('no Shape "plymesh" in it')
    starts = numpy.cumsum([0] + [len(positions) for positions, _ in parts])
    return (numpy.concatenate([positions for positions, _ in parts]),
            numpy.concatenate([indices + start for (_, indices), start in zip(parts, starts)]))


def convert(source, target):
    """Writes the triangles of a file as .scn; returns how many there are."""
    positions, indices = read_pbrt(source) if source.suffix == ".pbrt" else read_triangles(source)
    header = numpy.array([int.from_bytes(b"SCN1", "little"), len(positions), len(indices), 0], "<u4")
    target.write_bytes(header.tobytes() + positions.astype("<f4").tobytes() + indices.astype("<u4").tobytes())
    return len(indices)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", type=pathlib.Path, metavar="REPOSITORIES | SCENE")
    parser.add_argument("target", type=pathlib.Path, metavar="OUTPUT")
    parser.add_argument("--file", action="store_true", help="SCENE is one file")
    parser.add_argument("--set", choices=["training", "held out"], help="these scenes only")
    arguments = parser.parse_args()
    if arguments.file:
        print(f"{arguments.target}: {convert(arguments.source, arguments.target)} triangles")
        return
    arguments.target.mkdir(parents=True, exist_ok=True)
    failures = 0
    for scene in json.loads((pathlib.Path(__file__).parent / "sources.json").read_text()):
        if arguments.set not in (None, scene["set"]):
            continue
        source = arguments.source / scene["repository"].replace("/", "+") / scene["path"]
        try:
            triangles = convert(source, arguments.target / f"{scene['name']}.scn")
            print(f"{scene['name']}: {scene['kind']}, {scene['set']}, {triangles} triangles")
        except Exception as error:  # one scene less: the libraries that read meshes throw many types
            failures += 1
            print(f"{scene['name']}: skipped: {source}: {error}", file=sys.stderr)
    if failures:
        sys.exit(f"convert.py: {failures} scenes skipped; clone their repositories into {arguments.source} as its help says")


if __name__ == "__main__":
    try:
        main()
    except (OSError, ValueError) as error:
        sys.exit(f"convert.py: {error}")
