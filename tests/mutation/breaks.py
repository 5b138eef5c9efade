"""The list of breaks, breaks.txt: what each changes, and where that is now."""

from dataclasses import dataclass
from pathlib import Path

from kernel_code import root, without_comments

list_file = Path(__file__).with_name("breaks.txt")
fields = ("name", "rule", "file", "line", "which", "to", "equivalent", "elsewhere")


@dataclass
class Break:
    name: str
    rule: str
    file: str
    line: str  # its code, without comments and the blanks around
    which: int  # of the equal lines of the file, from 1
    to: str
    equivalent: str = ""  # the reason why no result can change
    elsewhere: str = ""  # the reason why no result can change on PoCL, although it may on other devices

    def number(self) -> int | None:
        """Of the line, from 1; None if the file has it no longer."""
        found = numbers_of(self.file, self.line)
        return found[self.which - 1] if self.which <= len(found) else None


def code_lines(file: str) -> list[str]:
    path = root / file
    return [line.strip() for line in without_comments(path.read_text()).split("\n")] if path.exists() else []


def numbers_of(file: str, line: str) -> list[int]:
    return [number for number, code in enumerate(code_lines(file), 1) if code == line]


def read(path: Path) -> list[Break]:
    """Blocks of lines "field: value"; a block begins with its name."""
    blocks: list[dict[str, str]] = []
    for line in path.read_text().splitlines():
        if not line or line.startswith("#"):
            continue
        field, _, value = line.partition(": ")
        if field not in fields or (field != "name" and not blocks):
            raise SystemExit(f"{path.name}: '{line}' is no line of a break")
        if field == "name":
            blocks.append({})
        blocks[-1][field] = value
    return [Break(**{**block, "which": int(block["which"])}) for block in blocks]


def text_of(breaks: list[Break]) -> str:
    blocks = ("".join(f"{field}: {getattr(each, field)}\n" for field in fields if getattr(each, field)) for each in breaks)
    return "\n".join(blocks)
