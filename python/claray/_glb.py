"""A binary glTF file, put together from arrays."""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

_COMPONENTS = {"float32": 5126, "uint32": 5125, "uint8": 5121}
_SHAPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}


class Glb:
    """The parts of a file; `json` holds all that is not in the buffer."""

    def __init__(self) -> None:
        self.json: dict[str, Any] = {"asset": {"version": "2.0", "generator": "claray"}, "scene": 0, "scenes": [{"nodes": []}]}
        self._bytes = bytearray()
        self._used: set[str] = set()

    def add(self, kind: str, value: dict[str, Any]) -> int:
        """Adds an object of a kind, such as "nodes", and returns its number."""
        self.json.setdefault(kind, []).append(value)
        return len(self.json[kind]) - 1

    def add_node(self, node: dict[str, Any]) -> int:
        """Adds a node to the scene."""
        number = self.add("nodes", node)
        self.json["scenes"][0]["nodes"].append(number)
        return number

    def use(self, extension: str) -> None:
        self._used.add(extension)

    def extension(self, owner: dict[str, Any], name: str) -> dict[str, Any]:
        """The object of an extension of `owner`."""
        self.use(name)
        made: dict[str, Any] = owner.setdefault("extensions", {}).setdefault(name, {})
        return made

    def view(self, data: bytes | NDArray[Any]) -> int:
        """Adds bytes to the buffer and returns the number of their view."""
        self._bytes += b"\0" * (-len(self._bytes) % 4)
        start = len(self._bytes)
        self._bytes += data if isinstance(data, bytes) else np.ascontiguousarray(data).tobytes()
        return self.add("bufferViews", {"buffer": 0, "byteOffset": start, "byteLength": len(self._bytes) - start})

    def accessor(self, array: NDArray[Any], bounds: bool = False) -> int:
        """Adds rows of numbers. bounds: whether their least and largest values are told, as glTF wants of positions."""
        columns = 1 if array.ndim == 1 else array.shape[1]
        made: dict[str, Any] = {"bufferView": self.view(array), "componentType": _COMPONENTS[array.dtype.name], "count": len(array),
                                "type": _SHAPES[columns]}
        if bounds:
            made["min"], made["max"] = array.min(0).tolist(), array.max(0).tolist()
        return self.add("accessors", made)

    def bytes(self) -> bytes:
        if self._bytes:
            self.json["buffers"] = [{"byteLength": len(self._bytes)}]
        if self._used:
            self.json["extensionsUsed"] = sorted(self._used)
        text = json.dumps(self.json, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        data = bytes(self._bytes) + b"\0" * (-len(self._bytes) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text
        if data:
            chunks += struct.pack("<I4s", len(data), b"BIN\0") + data
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
