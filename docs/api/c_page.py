#!/usr/bin/env python3
"""Writes the tables of docs/c.md: for each function and struct of C++ its counterpart in C, or the reason why there is none.

Usage: c_page.py [--check]: compares the page instead, and fails if anything of C++ has neither.

Counterparts with equal names are found by rule; docs/api/c_counterparts.txt names the others.
"""

import re
import sys

from interfaces import Declared, c, cpp, root

page = root / "docs/c.md"
begin = "<!-- What follows is written by docs/api/c_page.py. -->\n"
handles = {"Device": "device", "Bvh": "bvh", "InstancedBvh": "instances", "Query": "query", "Primitives": "primitives",
           "Renderer": "renderer", "RenderGroup": "group", "Sensor": "sensor", "SensorWorld": "sensor_world"}
endings = ("", "_create", "_get", "_build", "_with", "_enqueue")
# Classes whose members are no data for users.
opaque = {"Bvh", "Buffer", "Device", "EffectSet", "Error", "InstancedBvh", "Kernel", "Primitives", "Profiler", "Query", "Renderer",
          "RenderGroup", "Sensor", "SensorWorld", "Warnings", "Aovs"}


class Counterparts:
    """The rows of c_counterparts.txt: NAME = NAMES of C, or NAME - REASON."""

    def __init__(self, text: str) -> None:
        self.names: dict[str, list[str]] = {}
        self.reasons: dict[str, str] = {}
        self.used: set[str] = set()
        for number, line in enumerate(text.splitlines(), 1):
            row = re.match(r"((?:struct )?[\w:./]+) ([=-]) (.+)", line)
            if row and row[2] == "=":
                self.names[row[1]] = row[3].split()
            elif row:
                self.reasons[row[1]] = row[3]
            elif line.strip() and not line.startswith("#"):
                raise SystemExit(f"c_counterparts.txt:{number}: is no row: {line}")

    def find(self, name: str) -> list[str] | None:
        self.used.add(name)
        return self.names.get(name)

    def reason(self, *names: str) -> str | None:
        for name in names:
            if name in self.reasons:
                self.used.add(name)
                return self.reasons[name]
        return None

    def unused(self) -> set[str]:
        return (set(self.names) | set(self.reasons)) - self.used


def by_rule(name: str, functions: dict[str, str]) -> list[str]:
    """claray_device_open for Device::open, claray_count_hits and claray_count_hits_with for count_hits."""
    scope, _, last = name.rpartition("::")
    if scope and scope not in handles:
        return []
    stem = f"claray_{handles[scope]}_{last}" if scope else f"claray_{last}"
    stems = [stem] if scope else [stem, f"claray_scene_{last}"]
    return [one + ending for one in stems for ending in endings if one + ending in functions]


def function_rows(of_cpp: Declared, of_c: Declared, counterparts: Counterparts, faults: list[str]) -> dict[str, list[str]]:
    """Rows of the table of each header. One stands for all functions of a class that have no counterpart of their own."""
    rows: dict[str, list[str]] = {}
    classes: set[str] = set()
    for name, header in sorted(of_cpp.functions.items(), key=lambda item: (item[1], item[0].lower())):
        named = counterparts.find(name)
        found = named if named is not None else by_rule(name, of_c.functions)
        if unknown := [one for one in found if one not in of_c.functions]:
            faults.append(f"c_counterparts.txt: {name}: claray.h has no {unknown[0]}")
        text = ", ".join(f"`{one}`" for one in found)
        if not found:
            reason = counterparts.reason(name, name.rpartition("::")[0] or name, header)
            text = reason or "MISSING"
            if reason is None:
                faults.append(f"{name} of {header} has no function of C and no reason in docs/api/c_counterparts.txt")
            if (of := name.rpartition("::")[0]) in counterparts.reasons and name not in counterparts.reasons:
                if of not in classes:
                    rows.setdefault(header, []).append(f"| other functions of `{of}` | {text} |\n")
                classes.add(of)
                continue
        rows.setdefault(header, []).append(f"| `{name}` | {text} |\n")
    return rows


def members_in_c(name: str, members: list[str], in_c: set[str], of_c: Declared, counterparts: Counterparts, faults: list[str]) -> str:
    """What differs between a struct of C++ and that of C."""
    notes = []
    for member in members:
        path = f"{name}::{member}"
        if other := counterparts.find(path):
            notes.append(f"`{member}`: " + ", ".join(f"`{one}`" for one in other))
            faults += [f"c_counterparts.txt: {path}: C has no {one}" for one in other
                       if one not in in_c and one not in of_c.functions and one not in of_c.types]
        elif member not in in_c:
            reason = counterparts.reason(path)
            notes.append(f"`{member}`: {reason or 'MISSING'}")
            if reason is None:
                faults.append(f"{path} has no member in C and no reason in docs/api/c_counterparts.txt")
    return ". ".join(notes)


def struct_rows(of_cpp: Declared, of_c: Declared, counterparts: Counterparts, faults: list[str]) -> list[str]:
    rows = []
    for name, struct in sorted(of_cpp.structs.items()):
        if name in opaque:
            continue
        same = "claray_" + re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name.replace("::", "_")).replace("__", "_").lower()
        names = counterparts.find(f"struct {name}") or ([same] if same in of_c.structs else None)
        if names is None:
            if struct.header in counterparts.reasons:
                continue
            reason = counterparts.reason(f"struct {name}")
            if reason is None:
                faults.append(f"the struct {name} has none in C and no reason in docs/api/c_counterparts.txt")
            rows.append(f"| `{name}` | {reason or 'MISSING'} | |\n")
            continue
        in_c: set[str] = set()
        for one in names:
            if one in of_c.structs:
                in_c |= set(of_c.structs[one].members)
            elif one not in of_c.functions and one not in of_c.types:
                faults.append(f"c_counterparts.txt: struct {name}: claray.h has no {one}")
        notes = members_in_c(name, list(struct.members), in_c, of_c, counterparts, faults)
        rows.append(f"| `{name}` | {', '.join(f'`{one}`' for one in names)} | {notes} |\n")
    return rows


def generated(faults: list[str]) -> str:
    of_cpp, of_c = cpp(), c()
    counterparts = Counterparts((root / "docs/api/c_counterparts.txt").read_text())
    functions = function_rows(of_cpp, of_c, counterparts, faults)
    of_scope = [name for name, header in of_cpp.functions.items() if header not in counterparts.reasons]
    have = sum(1 for name in of_scope if counterparts.names.get(name) or by_rule(name, of_c.functions))
    text = (f"## Functions\n\nOf {len(of_scope)} functions of C++ in the headers below, {have} have counterparts. "
            "The others have a reason why not. Overloads of one name have one row.\n\n| C++ | C |\n|---|---|\n")
    for header, rows in functions.items():
        if header in counterparts.reasons:
            text += f"| all of `{header}` | {counterparts.reasons[header]} |\n"
            counterparts.used.add(header)
        else:
            text += f"| **`{header}`** | |\n" + "".join(rows)
    text += "\n## Structs\n\nMembers have the same names, except for those in the last column.\n\n"
    text += "| C++ | C | members |\n|---|---|---|\n"
    text += "".join(struct_rows(of_cpp, of_c, counterparts, faults))
    told = set(re.findall(r"`(claray_\w+)`", text))
    alone = sorted(name for name in of_c.functions if name not in told and not name.endswith("_release"))
    text += "\n## Functions of C alone\n\nThey read handles, or do what C++ does by members of a struct. "
    text += "Each type of handle also has a `_release` function.\n\n"
    text += "".join(f"- `{name}`\n" for name in alone)
    faults += [f"c_counterparts.txt: {name}: C++ has no such name" for name in sorted(counterparts.unused())]
    return text


def main() -> int:
    if sys.argv[1:] not in ([], ["--check"]):
        sys.exit("c_page.py: use no argument, or --check")
    faults: list[str] = []
    text = page.read_text()
    prose = text[:text.index(begin) + len(begin)]
    whole = prose + "\n" + generated(faults)
    if sys.argv[1:] == ["--check"]:
        if whole != text:
            faults.append("docs/c.md differs from the headers: run python3 docs/api/c_page.py")
    else:
        page.write_text(whole)
    for fault in faults:
        print(fault, file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
