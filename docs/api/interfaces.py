"""What the public headers declare: functions and structs of C++ (include/claray) and of C (include/claray.h).

The headers have one style, which clang-format keeps, so that no compiler is needed to read them.
"""

import re
from pathlib import Path
from typing import Iterator, NamedTuple

root = Path(__file__).resolve().parents[2]


class Struct(NamedTuple):
    header: str
    members: dict[str, str]  # declarations by names


class Declared(NamedTuple):
    functions: dict[str, str]  # the header of each "name" or "Class::name"
    structs: dict[str, Struct]
    types: set[str]  # all types of C: structs, handles, enumerations, callbacks


def without_comments(text: str) -> str:
    """Without comments, preprocessor lines and the contents of texts."""
    text = re.sub(r'"(\\.|[^"\\\n])*"|//[^\n]*|/\*.*?\*/', lambda part: '""' if part[0][0] == '"' else " ", text, flags=re.DOTALL)
    text = re.sub(r"^[ \t]*#(.*\\\n)*.*$", "", text, flags=re.MULTILINE)
    return re.sub(r"\bCLARAY_[A-Z_]+\([A-Z_, ]+\)", "", text)  # rows of a list


def closing(text: str, begin: int) -> int:
    """Behind the brace that closes the one at `begin`."""
    depth = 0
    for i in range(begin, len(text)):
        depth += (text[i] == "{") - (text[i] == "}")
        if depth == 0:
            return i + 1
    raise ValueError("a brace is not closed")


def statements(text: str) -> Iterator[tuple[str, str]]:
    """Each declaration, and the body of a scope or function."""
    begin = i = 0
    while i < len(text):
        if text[i] == ";":
            yield text[begin:i], ""
            begin = i + 1
        elif text[i] == "{":
            end, head = closing(text, i), text[begin:i]
            scope = re.match(r"(\s*\w+:(?!:))*\s*(template\s*<[^{}]*>\s*)?(namespace|class|struct|enum|union|extern)\b", head)
            if scope or ("(" in head and "=" not in head.split(")")[-1]):
                yield head, text[i + 1:end - 1]
                begin = end
            i = end - 1  # else an initializer
        i += 1


def unbracketed(text: str) -> str:
    """Without what is in brackets, attributes and `template <...>`."""
    text = re.sub(r"\[\[\w+\]\]|\btemplate\s*<[^()]*?>(?=\s*(class|struct|void|\[|\w))", " ", text)
    while (shorter := re.sub(r"<[^<>]*>", "", text)) != text:
        text = shorter
    return text


def function_of(head: str) -> str:
    """The name that a declaration gives to a function; "" for other declarations."""
    head = unbracketed(head)
    before = head.split("(")[0]
    if "(" not in head or "=" in before or "operator" in head or re.match(r"\s*(using|friend|typedef|static_assert)\b", head):
        return ""
    name = re.search(r"(~?\w+)\s*$", before)
    return name[1] if name else ""


def without_pairs(text: str, pair: str) -> str:
    """Without balanced brackets and what is in them."""
    innermost = re.compile(rf"\{pair[0]}[^{re.escape(pair)}]*\{pair[1]}")
    while (shorter := innermost.sub("", text)) != text:
        text = shorter
    return text


def members_of(head: str) -> Iterator[tuple[str, str]]:
    """The names and types of data members."""
    if "operator" in head or re.match(r"\s*(using|friend|typedef|static|enum|(struct|class) \w+\s*$)", head):
        return
    plain = without_pairs(unbracketed(without_pairs(head, "{}")), "()")
    for part in plain.split(","):
        if name := re.search(r"(\w+)\s*(\[\w*\])?\s*$", part.split("=")[0]):
            yield name[1], " ".join(plain.split())


def read_cpp(text: str, declared: Declared, header: str, scope: str = "", public: bool = True) -> None:
    for head, body in statements(text):
        labels = list(re.finditer(r"\b(public|private|protected):", head))
        if labels:
            public, head = labels[-1][1] == "public", head[labels[-1].end():]
        if named := re.match(r"\s*namespace\s+(\w+)", head):
            if named[1] != "detail":
                read_cpp(body, declared, header)
            continue
        kind = re.match(r"\s*(?:template\s*<[^{}]*>\s*)?(class|struct)\s+(\w+)(?:\s+final)?\s*(?::[^:].*)?$", head, re.DOTALL)
        if kind and body and public:
            name = f"{scope}::{kind[2]}" if scope else kind[2]
            declared.structs[name] = Struct(header, {})
            read_cpp(body, declared, header, name, kind[1] == "struct")
        elif re.match(r"\s*(enum|class|struct\s+\w+\s*$)", head) or not public:
            continue
        elif name := function_of(head):
            if not name.startswith("~"):
                declared.functions.setdefault(f"{scope}::{name}" if scope else name, header)
        elif scope:
            declared.structs[scope].members.update(members_of(head))


def cpp() -> Declared:
    declared = Declared({}, {}, set())
    for path in sorted((root / "include/claray").rglob("*.hpp")):
        read_cpp(without_comments(path.read_text()), declared, str(path.relative_to(root / "include")))
    return declared


def c() -> Declared:
    """Types of functions stand in place of the header: "claray_status(claray_device* device)"."""
    text = without_comments((root / "include/claray.h").read_text())
    declared = Declared({}, {}, set())
    for result, name, arguments in re.findall(r"CLARAY_API\s+([\w \*]+?)(claray_\w+)\(([^;]*)\);", text):
        declared.functions[name] = f"{' '.join(result.split())}({' '.join(arguments.split())})"
    declared.types.update(re.findall(r"(?:struct |enum |\(\*)(claray_\w+)", text))
    for name, body in re.findall(r"struct (claray_\w+) \{(.*?)\n?\}", text, re.DOTALL):
        declared.structs[name] = Struct("claray.h", {})
        for head, _ in statements(body):
            for member in members_of(head):
                declared.structs[name].members.update([member])
    return declared
