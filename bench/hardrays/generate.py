"""Writes the cases of hard rays as FOLDER/NAME.npz, and prints their sizes.

    python3 bench/hardrays/generate.py [FOLDER] [--only NAME...] [--hashes]

FOLDER is out/hardrays by default. --hashes: instead of files, prints the SHA-256 of each case's arrays, as hashes.txt has them.
"""

import argparse
import hashlib
import os
import sys
import time

import numpy as np

from cases import CASES


def hash_of(case):
    """The SHA-256 of names, types, shapes and bytes of the arrays, by name."""
    total = hashlib.sha256()
    for name in sorted(case):
        values = np.ascontiguousarray(case[name])
        total.update(f"{name} {values.dtype.str} {values.shape}\n".encode())
        total.update(values.tobytes())
    return total.hexdigest()


def committed_hashes():
    with open(os.path.join(os.path.dirname(__file__), "hashes.txt")) as file:
        return {name: value for value, name in (line.split() for line in file)}


def write(name, folder):
    case = CASES[name]()
    os.makedirs(folder, exist_ok=True)
    path = os.path.join(folder, name + ".npz")
    np.savez(path, **case)
    return path, case


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", default="out/hardrays")
    parser.add_argument("--only", nargs="+", choices=CASES, default=list(CASES), metavar="NAME")
    parser.add_argument("--hashes", action="store_true")
    options = parser.parse_args()
    for name in options.only:
        begin = time.perf_counter()
        if options.hashes:
            print(hash_of(CASES[name]()), name, flush=True)
            continue
        path, case = write(name, options.folder)
        print("%-16s %6d triangles %7d queries %5.1f s  %s" % (name, len(case["triangles"]), len(case.get("points", case.get("origins"))),
                                                           time.perf_counter() - begin, path), flush=True)


if __name__ == "__main__":
    sys.exit(main())
