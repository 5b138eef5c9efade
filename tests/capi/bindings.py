"""claray.h for ctypes: its structs and functions, made from the header as generators of bindings do."""

import ctypes
import re
import sys
from pathlib import Path
from typing import Any

root = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(root / "docs/api"))
import interfaces  # noqa: E402

scalars = {"void": None, "char": ctypes.c_char, "int": ctypes.c_int, "size_t": ctypes.c_size_t, "float": ctypes.c_float,
           "double": ctypes.c_double, "uint8_t": ctypes.c_uint8, "int32_t": ctypes.c_int32, "uint32_t": ctypes.c_uint32,
           "uint64_t": ctypes.c_uint64}


class Header:
    """Attributes: enums (values by names), structs and functions (types by names). Handles are void pointers."""

    def __init__(self) -> None:
        text = interfaces.without_comments((root / "include/claray.h").read_text())
        self.text = text
        self.enums: dict[str, dict[str, int]] = {}
        for name, body in re.findall(r"typedef enum (claray_\w+) \{(.*?)\}", text, re.DOTALL):
            self.enums[name] = {row: int(value) for row, value in re.findall(r"(\w+) = (\d+)", body)}
        self.callbacks = {name: self.signature(result, arguments) for result, name, arguments in
                          re.findall(r"typedef (\w+) \(\*(claray_\w+)\)\(([^;]*)\);", text)}
        declared = interfaces.c()
        self.structs: dict[str, type[ctypes.Structure]] = {
            name: type(name, (ctypes.Structure,), {}) for name in declared.structs}
        for name, struct in declared.structs.items():
            self.structs[name]._fields_ = [(member, self.member(member, head)) for member, head in struct.members.items()]
        self.functions = {name: self.signature(*re.fullmatch(r"(.*?)\((.*)\)", head).groups())  # type: ignore[union-attr]
                          for name, head in declared.functions.items()}
        self.arguments = {name: [] if head.endswith("(void)") else
                          [part.strip() for part in head[head.index("(") + 1:-1].split(",")] for name, head in declared.functions.items()}

    def value(self, text: str) -> Any:
        """The type of "const float* name", "float[6]" or "claray_layout"."""
        base = re.sub(r"\b(const|struct)\b", "", text).split("*")[0].split()[0]
        pointers = text.count("*")
        if pointers == 1 and base == "char":
            return ctypes.c_char_p
        if pointers:
            return ctypes.c_void_p
        if base in self.enums:
            return ctypes.c_int
        if base in getattr(self, "callbacks", {}):
            return self.callbacks[base]
        if base in scalars:
            return scalars[base]
        return self.structs[base]

    def member(self, name: str, head: str) -> Any:
        kind = self.value(head)
        size = re.search(rf"\b{name}\[(\d+)\]", head)
        return kind * int(size[1]) if size else kind

    def signature(self, result: str, arguments: str) -> Any:
        parts = [] if arguments.strip() == "void" else [part.strip() for part in arguments.split(",")]
        return ctypes.CFUNCTYPE(self.value(result), *(ctypes.c_void_p if "[" in part else self.value(part) for part in parts))

    def bind(self, library: str) -> dict[str, Any]:
        """The functions of a shared library."""
        handle = ctypes.CDLL(library)
        return {name: kind((name, handle)) for name, kind in self.functions.items()}
