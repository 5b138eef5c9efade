"""The kernels as a compiler sees them: what includes what, for which macros each is compiled, which lines take part, and what becomes of them."""

import re
import subprocess
import tempfile
from functools import cache
from pathlib import Path
from typing import NamedTuple

root = Path(__file__).resolve().parents[2]
folders = ("kernels", "include/claray/shared")

# Values that the host gives macros, beside those of cmake/LintKernels.cmake. A kernel is compiled for one of them after the other.
other_values = [("KEY_BITS", "32"), ("GROUP_SIZE", "1"), ("GROUP", "1u"), ("LEAF_SHAPE", "1"), ("LEAF_SHAPE", "2"), ("LIGHT_GRID", "1"),
                ("PATH_GUIDE", "1"), ("BAKE", "1"), ("SORTED", "1"), ("BRUTE_FORCE", "1"), ("EVERY_INSTANCE", "1"), ("CULL_BACK_FACES", "1"),
                ("CLARAY_CLOSED_TRIANGLES", "1"), ("CLARAY_RAY_MASKS", "1"), ("CLARAY_CUTOUTS", "1"), ("CLARAY_PRIMITIVES", "1"),
                ("CLARAY_SMALL", "1"), ("CLARAY_WIDE", "1"), ("SIXTEEN", "0"), ("SIXTEEN", "1"), ("SHADING", "CLARAY_FLAT"),
                ("SHADING", "CLARAY_GOURAUD"), ("PRIMITIVE_CAPSULES", "1"), ("RAY_QUEUE", "0"), ("CHOOSE", "1"), ("MAX_LEAF", "1")]


class Variant(NamedTuple):
    kernel: str  # its path
    options: tuple[str, ...]
    is_linted: bool  # by cmake/LintKernels.cmake, for which it must compile

    @property
    def is_for_cpus(self) -> bool:
        return not {"-DCLARAY_CPU=0", "-triple"} & set(self.options)


def without_comments(text: str) -> str:
    """The text with blanks in place of comments, so that nothing moves."""
    return re.sub(r"//[^\n]*|/\*.*?\*/", lambda comment: re.sub(r"[^\n]", " ", comment[0]), text, flags=re.DOTALL)


@cache
def with_included(path: str) -> frozenset[str]:
    """The paths of a file and of all that it includes."""
    found, left = set(), [path]
    while left:
        file = left.pop()
        if file in found:
            continue
        found.add(file)
        for name in re.findall(r'^ *# *include "([^"]+)', (root / file).read_text(), re.MULTILINE):
            left += [f"{folder}/{name}" for folder in ("kernels", "include") if (root / folder / name).exists()]
    return frozenset(found)


def is_mentioned(macro: str, kernel: str) -> bool:
    return any(re.search(rf"\b{macro}\b", (root / file).read_text()) for file in with_included(kernel))


@cache
def variants() -> list[Variant]:
    """How programs compile the kernels. Those that only studies and comparisons with textbooks use are left out."""
    with tempfile.NamedTemporaryFile("r") as file:
        subprocess.run(["cmake", f"-DSOURCE_DIR={root}", f"-DVARIANTS={file.name}", "-P", root / "cmake/LintKernels.cmake"], check=True)
        lines = [line.split("\t") for line in file.read().splitlines()]
    found: dict[Variant, None] = {}
    for kind, kernel, options in lines:
        if kernel.startswith("kernels/accuracy/") or re.match("textbook|studied", kind):
            continue
        options = tuple(options.split(";")) if options else ()
        found[Variant(kernel, options, True)] = None
        if kind != "effects":
            continue
        for macro, value in other_values:
            if is_mentioned(macro, kernel) and not any(option.startswith(f"-D{macro}=") for option in options):
                found[Variant(kernel, options + (f"-D{macro}={value}",), False)] = None
    return list(found)


def variants_with(path: str) -> list[Variant]:
    return [variant for variant in variants() if path in with_included(variant.kernel)]


@cache
def clang() -> list[str]:
    resources = subprocess.run(["clang-14", "-print-resource-dir"], check=True, capture_output=True, text=True).stdout.strip()
    return ["clang-14", "-cc1", "-x", "cl", "-cl-std=CL1.2", "-internal-isystem", f"{resources}/include", "-finclude-default-header",
            "-fdeclare-opencl-builtins", "-w", "-Iinclude", "-Ikernels"]


def compiled(variant: Variant, options: list[str], folder: Path = root) -> str | None:
    """What the compiler makes of the kernels in a folder; None if it cannot compile them."""
    done = subprocess.run([*clang(), *variant.options, *options, variant.kernel, "-o", "-"], cwd=folder, capture_output=True, text=True)
    return done.stdout if done.returncode == 0 else None


def compiles(variant: Variant, folder: Path) -> bool:
    return compiled(variant, ["-fsyntax-only"], folder) is not None


def code_of(variant: Variant, folder: Path = root) -> str | None:
    """The optimized code, without names."""
    return compiled(variant, ["-O2", "-emit-llvm", "-discard-value-names"], folder)


def lines_of(variant: Variant) -> set[tuple[str, int]]:
    """The lines, with their paths, that the kernel functions of a variant reach: without optimization clang leaves out only what nothing calls."""
    code = compiled(variant, ["-O0", "-emit-llvm", "-debug-info-kind=line-tables-only"]) or ""
    nodes = dict(re.findall(r"^(!\d+) = (?:distinct )?(!DI(?:File|Subprogram|LexicalBlock|LexicalBlockFile)\(.*)", code, re.MULTILINE))

    @cache
    def file_of(node: str) -> str:
        text = nodes.get(node, "")
        if name := re.match(r'!DIFile\(filename: "([^"]*)"', text):
            return name[1]
        parent = re.search(r"\bfile: (!\d+)", text) or re.search(r"\bscope: (!\d+)", text)
        return file_of(parent[1]) if parent else ""

    locations = re.findall(r"!DILocation\(line: (\d+), (?:column: \d+, )?scope: (!\d+)", code)
    return {(file_of(scope), int(line)) for line, scope in set(locations)}
