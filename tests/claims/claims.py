"""Measured figures: what each page states (pages/*.toml), and what a command prints.

A file begins with `page`. [[command]]: `run`, a line of bash, and for all of its rows
  device     any, cpu, gpu or nvidia-h200 [any]; $CLARAY_DEVICE is cpu or gpu
  needs      files of the folder that --files names, programs, and modules as python:NAME; programs of build/bin need not be named
  limit      seconds [120]; a command with more than 600 runs only if its row or its page is named
  exit       the exit code [0]
[[command.row]]: a figure that the command prints
  name
  quote      text that stands on the page once, with the figure in braces; "{1.1 to 1.2}" is an interval
  read       a regular expression whose group is the printed figure; `over`: the figure is divided by the group of this one
  json       in place of `read`: the figure's path in printed JSON, as build.milliseconds
  combine    of all figures that `read` finds: first, sum, least, most, count, mean or geometric mean [first]
  scale      the printed figure times this has the page's unit [1]
  value      the figure as a number, where the page has words
  tolerance  0.1: from the value over 1.1 to the value times 1.1 [0: as rounded on the page]
  bound      "at most" or "at least", where the page says so
[[no_measurement]]: `text` of README whose numbers nothing measures, and `why`
Hashes and counts are exact. Times of GPUs have a tolerance of 0.15, and those of CPUs, which share their machine, of 1.
"""

import json
import re
import statistics
import tomllib
from dataclasses import dataclass, fields
from functools import cache
from pathlib import Path
from typing import Iterator, NamedTuple

root = Path(__file__).resolve().parents[2]
folder = Path(__file__).with_name("pages")


class DeviceClass(NamedTuple):
    kinds: tuple[str, ...]
    name: str = ""  # a regular expression that finds the device in what `claray devices` prints


classes = {"any": DeviceClass(("gpu", "cpu")), "cpu": DeviceClass(("cpu",)), "gpu": DeviceClass(("gpu",)),
           "nvidia-h200": DeviceClass(("gpu",), r"NVIDIA H200\b")}
bounds = ("", "at least", "at most")
combinations = {"first": lambda found: found[0], "sum": sum, "least": min, "most": max, "count": len, "mean": statistics.mean,
                "geometric mean": statistics.geometric_mean}
number = r"-?\d[\d,]*(?:\.\d+)?(?:e[-+]?\d+)?"


@dataclass(frozen=True)
class Row:
    name: str
    page: str
    quote: str  # text of the page, with the figure in braces
    command: str
    device: str = "any"
    needs: tuple[str, ...] = ()  # files, programs, and modules of Python as python:NAME
    limit: float = 120  # seconds
    exit: int = 0  # the command's exit code
    read: str = ""  # a regular expression: its one group is the figure
    over: str = ""  # another one: the figure is divided by its group
    json: str = ""  # instead of `read`: the path of the figure in the JSON that the command prints
    combine: str = "first"  # of several figures that `read` finds
    scale: float = 1  # the printed figure times this has the page's unit
    value: float | None = None  # if the page states it in words
    tolerance: float = 0  # 0.1: from the value over 1.1 to the value times 1.1
    bound: str = ""

    def figure(self) -> str:
        return re.fullmatch(r"[^{}]*\{([^{}]+)\}[^{}]*", self.quote)[1]

    def faults(self) -> list[str]:
        """What the list itself gets wrong."""
        found = [f"{self.name}: no {what}" for what, is_there in (
            (f"class of device '{self.device}'", self.device in classes), (f"bound '{self.bound}'", self.bound in bounds),
            (f"combination '{self.combine}'", self.combine in combinations), (f"page {self.page}", (root / self.page).is_file()),
            ("way to read the figure: one of `read` and `json`", bool(self.read) != bool(self.json))) if not is_there]
        found += [f"{self.name}: '{pattern}' has not one group" for pattern in (self.read, self.over)
                  if pattern and re.compile(pattern).groups != 1]
        if not re.fullmatch(r"[^{}]*\{[^{}]+\}[^{}]*", self.quote):
            return [*found, f"{self.name}: the quote has not one figure in braces"]
        if self.value is None and interval(self.figure()) is None and not is_hash(self.figure()):
            found.append(f"{self.name}: '{self.figure()}' is no number, and there is no `value`")
        return found

    def reads(self, output: str) -> str | float | None:
        """The figure that the command printed."""
        if self.json:
            return at_path(output, self.json)
        found = re.findall(self.read, output, re.MULTILINE)
        if is_hash(self.figure()):
            return found[0] if found else None
        divisor = re.search(self.over, output, re.MULTILINE) if self.over else None
        if not found and self.combine != "count" or self.over and not divisor:
            return None
        figures = found if self.combine == "count" else [parsed(text) for text in found]
        return combinations[self.combine](figures) / (parsed(divisor[1]) if divisor else 1)

    def holds(self, measured: str | float) -> bool:
        if isinstance(measured, str):
            return measured == self.figure()
        measured *= self.scale
        low, high = (self.value, self.value) if self.value is not None else interval(self.figure())
        half = 0 if self.value is not None else half_a_unit(self.figure())
        widened = 1 + self.tolerance
        low, high = (low / widened if low > 0 else low * widened) - half, (high * widened if high > 0 else high / widened) + half
        return (self.bound == "at most" or measured >= low - 1e-9) and (self.bound == "at least" or measured <= high + 1e-9)


def parsed(text: str) -> float:
    return float(text.replace(",", ""))


def is_hash(text: str) -> bool:
    return bool(re.fullmatch(r"[0-9a-f]{32,64}", text))


def interval(figure: str) -> tuple[float, float] | None:
    """1.5 is from 1.5 to 1.5, and "1.1 to 1.2" is from 1.1 to 1.2."""
    found = re.fullmatch(f"({number})(?: to ({number}))?", figure)
    return (parsed(found[1]), parsed(found[2] or found[1])) if found else None


def half_a_unit(figure: str) -> float:
    """What rounding to the digits of the page may change."""
    if "e" in figure:
        return 0
    decimals = re.search(r"\.(\d+)$", figure)
    return 0.5 * 10 ** -len(decimals[1]) if decimals else 0.5 if "." not in figure else 0


def at_path(output: str, path: str) -> float | None:
    """a.0.b of the last line or the whole of the output that is JSON."""
    texts = [output[output.find("{"):], *reversed(output.splitlines())]
    for text in texts:
        try:
            value = json.loads(text)
            for step in path.split("."):
                value = value[int(step) if isinstance(value, list) else step]
            return float(value)
        except (ValueError, KeyError, IndexError, TypeError):
            continue
    return None


def read_lists() -> tuple[list[Row], list[str]]:
    """The rows of all pages, and the phrases of README whose numbers are no measurements."""
    rows: list[Row] = []
    phrases: list[str] = []
    for file in sorted(folder.glob("*.toml")):
        text = tomllib.loads(file.read_text(encoding="utf-8"))
        phrases += [phrase["text"] for phrase in text.get("no_measurement", [])]
        rows += [row for command in text["command"] for row in rows_of(file.name, text["page"], command)]
    return rows, phrases


def rows_of(file: str, page: str, command: dict) -> Iterator[Row]:
    shared = {key: value for key, value in command.items() if key not in ("run", "row")}
    for row in command["row"]:
        whole = {"page": page, "command": command["run"], **shared, **row}
        if unknown := set(whole) - {field.name for field in fields(Row)}:
            raise SystemExit(f"{file}: {row.get('name')}: no field {', '.join(sorted(unknown))}")
        yield Row(**{**whole, "needs": tuple(whole.get("needs", ()))})


@cache
def page_text(page: str) -> str:
    return (root / page).read_text(encoding="utf-8")


def places(text: str, page: str) -> list[tuple[int, int]]:
    """Where a page has a text, however its lines are broken. Braces mark the part whose place is returned."""
    start, _, rest = text.partition("{")
    middle, _, end = rest.partition("}")
    parts = [r"\s+".join(re.escape(word) for word in re.split(r"\s+", part)) for part in ((start, middle, end) if rest else ("", text, ""))]
    return [found.span(1) for found in re.finditer("{}({}){}".format(*parts), page_text(page))]


def line_of(page: str, place: int) -> int:
    return page_text(page).count("\n", 0, place) + 1


def check_itself() -> None:
    def row(figure: str, **others) -> Row:
        return Row("a", "README.md", "b {" + figure + "} c", "d", **others)

    assert row("1.05", read="(x)").holds(1.0549) and not row("1.05", read="(x)").holds(1.0551)
    assert row("2", tolerance=0.5).holds(1.2) and row("2", tolerance=0.5).holds(3.5) and not row("2", tolerance=0.5).holds(3.51)
    assert row("1.1 to 1.2").holds(1.15) and not row("1.1 to 1.2").holds(1.26)
    assert row("0.1", bound="at most").holds(-3) and not row("0.1", bound="at most").holds(0.2) and row("1,000", bound="at least").holds(2e6)
    assert row("seven", value=7).holds(7) and not row("seven", value=7).holds(7.1)
    assert row("0" * 32, read="(0+)").holds("0" * 32) and not row("0" * 32, read="(0+)").holds("1" * 32)
    assert row("4", read=r"x (\d+)", over=r"y (\d+)").reads("x 8\nx 9\ny 2") == 4
    assert row("3", read=r"^x (\d+)", combine="count").reads("x 8\nx 9") == 2 and row("3", read="(x)").reads("y") is None
    assert row("3", read=r"x (\S+)", combine="geometric mean").reads("x 2 x 8") == 4
    assert row("3", json="a.1.b").reads('told\n{"a": [0, {"b": 2}]}') == 2 and row("3", json="a").reads("{}") is None
    assert half_a_unit("1,000") == 0.5 and half_a_unit("0.25") == 0.005 and half_a_unit("1e-5") == 0
