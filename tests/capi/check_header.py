#!/usr/bin/env python3
"""claray.h as generators of bindings for other languages (bindgen, cffi) need it, and as programs rely on it.

Usage: check_header.py [LIBRARY]            checks the header, its layout in abi.txt, and what the shared library exports
       check_header.py --write [LIBRARY]    adds what is new to abi.txt; refuses to change what is there
"""

import ctypes
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Iterator

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).parent))
from bindings import Header, root  # noqa: E402

abi = Path(__file__).with_name("abi.txt")
path = root / "include/claray.h"


def faults_of_style(header: Header) -> Iterator[str]:
    """Only what every language has: structs of fixed size, passed by pointers, and numbers of fixed width."""
    text = header.text
    for word in ("union", "long", "short", "unsigned", "bool", "_Bool", "va_list", "wchar_t", "static", "inline"):
        if re.search(rf"\b{word}\b", text):
            yield f"claray.h has the word {word}"
    if "..." in text:
        yield "claray.h has a function of any number of arguments"
    for body in re.findall(r"struct \w+ \{(.*?)\n?\}", text, re.DOTALL):
        for head in body.split(";"):
            if re.search(r":\s*\d|\[\s*\]|\bint\b|\bchar \w", head):
                yield f"a member is no number of fixed width and no pointer: {' '.join(head.split())}"
    for name, kind in header.structs.items():
        names = [member for member, *_ in kind._fields_]
        if "struct_size" in names[1:]:
            yield f"{name} does not begin with struct_size"
    for name, values in header.enums.items():
        declared = len(re.findall(r"CLARAY_\w+", re.search(rf"typedef enum {name} \{{(.*?)\}}", text, re.DOTALL)[1]))  # type: ignore[index]
        if declared != len(values):
            yield f"an enumerator of {name} has no number"
    for name, arguments in header.arguments.items():
        if not re.fullmatch(r"claray_[a-z0-9_]+", name):
            yield f"{name} is no lower-case name with the prefix claray_"
        for argument in arguments:
            of = re.match(r"(?:const )?(claray_\w+) \w+$", argument)
            if of and of[1] in header.structs:
                yield f"{name} takes a {of[1]} by value"


def without_name(argument: str) -> str:
    """"float[6]" of "float bounds[6]"."""
    return re.sub(r"\s?\b\w+(?=\[\d+\]$|$)", "", argument)


def layout(header: Header) -> list[str]:
    """A line for each member, enumerator and function."""
    lines = []
    for name, kind in sorted(header.structs.items()):
        for member, *_ in kind._fields_:
            field = getattr(kind, member)
            lines.append(f"{name} {member} {field.offset} {field.size}")
        if "struct_size" not in [member for member, *_ in kind._fields_]:
            lines.append(f"{name} has no more members")
    lines += [f"{name} {row} = {value}" for name, rows in sorted(header.enums.items()) for row, value in rows.items()]
    lines += [f"{name}({', '.join(without_name(part) for part in parts)})" for name, parts in sorted(header.arguments.items())]
    return lines


def faults_of_compilers(header: Header) -> Iterator[str]:
    """The header compiles alone, the tests are C++, too, and the compiler agrees with ctypes about each offset."""
    compilers = [name for name in ("clang-14", "clang", "gcc", "cc") if shutil.which(name)][:1]
    asserts = "".join(f"_Static_assert(offsetof({name}, {member}) == {getattr(kind, member).offset}, \"\");\n"
                      for name, kind in header.structs.items() for member, *_ in kind._fields_)
    asserts += "".join(f"_Static_assert(sizeof({name}) == {ctypes.sizeof(kind)}, \"\");\n" for name, kind in header.structs.items())
    include = f'#include "{path}"\n'
    for compiler in compilers:
        for language, options, source in (("c", ["-std=c99", "-pedantic"], include), ("c", ["-std=c11"], include + asserts),
                                          ("c++", ["-std=c++11", "-pedantic"], include)):
            done = subprocess.run([compiler, "-x", language, *options, "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-"],
                                  input=source, text=True, capture_output=True)
            if done.returncode:
                yield f"{compiler} {' '.join(options)}: {done.stderr.strip()[:2000]}"
        tests = sorted(Path(__file__).parent.glob("*_test.c"))
        options = ["-std=c++11", "-Wall", "-Wextra", "-Wno-missing-field-initializers", "-Werror", "-fsyntax-only"]
        done = subprocess.run([compiler, "-x", "c++", *options, f"-I{path.parent}", "-DCL_TARGET_OPENCL_VERSION=120", *tests],
                              text=True, capture_output=True)
        if done.returncode:
            yield f"{compiler} with the tests as C++: {done.stderr.strip()[:2000]}"


def faults_of_library(header: Header, library: str) -> Iterator[str]:
    shown = subprocess.run(["nm", "-D", "--defined-only", "--format=posix", library], text=True, capture_output=True, check=True)
    exported = {line.split()[0] for line in shown.stdout.splitlines() if not line.startswith("_Z")}  # which are of C++
    yield from (f"the library lacks {name} of claray.h" for name in sorted(set(header.functions) - exported))
    yield from (f"the library exports {name}, which claray.h does not declare" for name in sorted(exported - set(header.functions)))


def main() -> int:
    header = Header()
    libraries = [one for one in sys.argv[1:] if one != "--write"]
    now, promised = layout(header), abi.read_text().splitlines() if abi.exists() else []
    faults = list(faults_of_style(header)) + list(faults_of_compilers(header))
    faults += [f"abi.txt promises, and claray.h breaks: {line}" for line in promised if line not in now]
    for name in {line.split()[0] for line in promised if line.endswith("has no more members")}:
        added = [line for line in now if line.startswith(name + " ") and line not in promised]
        faults += [f"{name} has no struct_size and must not grow: {line}" for line in added]
    if "--write" in sys.argv and not faults:
        abi.write_text("\n".join(now) + "\n")
    elif now != promised and not faults:
        faults.append("claray.h has more than abi.txt: run tests/capi/check_header.py --write")
    for library in libraries:
        faults += faults_of_library(header, library)
    print("\n".join(faults) or f"{len(header.structs)} structs, {len(header.enums)} enumerations, {len(header.functions)} functions")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
