"""Writes index.html from the CSV files of a folder: one page without scripts. A cell's command is its tooltip.

    python3 bench/league/page.py FOLDER
"""

import csv
import html
import math
import re
import statistics
import sys
from pathlib import Path

STYLE = """
:root { color-scheme: light dark; --text: #1c1c1c; --back: #ffffff; --line: #d0d0d0; --ours: #1f6fb5; --theirs: #9aa0a6; --good: #e3f1e3; }
@media (prefers-color-scheme: dark) {
  :root { --text: #e6e6e6; --back: #16181b; --line: #3a3d42; --ours: #62a8e5; --theirs: #6c727a; --good: #20361f; } }
body { font: 15px/1.5 system-ui, sans-serif; color: var(--text); background: var(--back); max-width: 76rem; margin: 2rem auto; padding: 0 1rem; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; margin: .5rem 0 1rem; }
.wide { overflow-x: auto; }
th, td { border-bottom: 1px solid var(--line); padding: .15rem .6rem; text-align: right; white-space: nowrap; }
th { white-space: normal; vertical-align: bottom; }
th:first-child, td:first-child, th.text { text-align: left; }
td.text { text-align: left; white-space: normal; }
td.best { background: var(--good); font-weight: 600; }
code { font: 13px ui-monospace, monospace; overflow-wrap: anywhere; }
svg { display: block; margin: .5rem 0 1.5rem; max-width: 100%; height: auto; }
svg text { fill: var(--text); font: 13px system-ui, sans-serif; }
.note { color: #c0392b; }
"""
KINDS = ("primary", "shadow", "bounce", "random")


def rows_of(folder, name):
    """Rows as dictionaries; none if the section failed."""
    path = Path(folder) / (name + ".csv")
    if not path.exists():
        return []
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def number(text):
    try:
        return float(text)
    except (TypeError, ValueError):
        return None


def short(value):
    """Three digits."""
    if value is None:
        return ""
    return "%.0f" % value if value >= 100 else "%.3g" % value


def text(value):
    return html.escape(str(value))


def table(header, rows):
    """A cell is text, or (text, tooltip, class)."""
    def cell(value, tag="td"):
        shown, tip, kind = value if isinstance(value, tuple) else (value, "", "")
        return "<%s%s%s>%s</%s>" % (tag, ' class="%s"' % kind if kind else "", ' title="%s"' % text(tip) if tip else "", text(shown), tag)

    head = "<tr>%s</tr>" % "".join(cell(name, "th") for name in header)
    return '<div class="wide"><table>%s%s</table></div>\n' % (head, "\n".join("<tr>%s</tr>" % "".join(map(cell, row)) for row in rows))


def bars(title, items, unit="", less=0):
    """Horizontal bars from the least power of ten on, on a logarithmic scale. `items`: (name, value, whether it is ours).

    `less`: what was added to the values so that none is zero.
    """
    items = [(name, value, ours) for name, value, ours in items if value]
    if not items:
        return ""
    low = 10.0 ** math.floor(math.log10(0.5 * min(value for _, value, _ in items)))
    high = max(max(value for _, value, _ in items), low * 10)
    width = lambda value: 420 * math.log(value / low) / math.log(high / low)
    lines = []
    for k, (name, value, ours) in enumerate(items):
        y = 22 * k + 4
        lines.append('<text x="250" y="%d" text-anchor="end">%s</text><rect x="260" y="%d" width="%.1f" height="16" style="fill:var(--%s)"/>'
                     '<text x="%.1f" y="%d">%s%s</text>' % (y + 13, text(name), y, max(width(value), 1), "ours" if ours else "theirs",
                                                          268 + width(value), y + 13, short(value - less), unit))
    return '<p>%s (logarithmic)</p><svg viewBox="0 0 780 %d" width="780" role="img">%s</svg>\n' % (text(title), 22 * len(items) + 8, "\n".join(lines))


def unique(values):
    return list(dict.fromkeys(values))


# ---- rays

def speed(row, measure):
    """Millions a second by the clock, or a second of processors."""
    took = number(row[measure])
    return float(row["count"]) / took / 1e3 if took else None


def over_best(rows, measure):
    """Ratios of claray's speed over the best peer's, by kind and scene."""
    ratios = {}
    for kind in unique(r["kind"] for r in rows if r["kind"]):
        for scene in unique(r["scene"] for r in rows if r["scene"]):
            here = {r["tracer"]: speed(r, measure) for r in rows if (r["scene"], r["kind"]) == (scene, kind)}
            ours, theirs = here.get("claray"), [s for name, s in here.items() if name != "claray" and s]
            if ours and theirs:
                ratios.setdefault(kind, {})[scene] = ours / max(theirs)
    return ratios


def mean(ratios):
    return statistics.geometric_mean(ratios.values())


def speeds(rows, kind, measure, ratios):
    tracers = unique(r["tracer"] for r in rows if r["scene"])
    lines = []
    for scene in unique(r["scene"] for r in rows if r["scene"]):
        here = {r["tracer"]: r for r in rows if (r["scene"], r["kind"]) == (scene, kind)}
        best = max([speed(r, measure) or 0 for r in here.values()], default=0)
        cells = [(short(speed(r, measure)) or re.sub(r".* hits, not .*", "other hits", r["note"]), ("%s %s" % (r["note"], r["command"])).strip(),
                  "best" if best and speed(r, measure) == best else "") for r in (here[t] for t in tracers if t in here)]
        lines.append([scene, *cells, short(ratios.get(kind, {}).get(scene))])
    return table(["scene", *tracers, "claray / best"], lines)


def settings(rows):
    found = unique((r["tracer"], r["version"], r["setting"]) for r in rows if r["scene"])
    missing = [(r["tracer"], "", (r["note"], "", "text")) for r in rows if not r["scene"]]
    return table(["tracer", "version", ("setting", "", "text")], [(t, v, (s, "", "text")) for t, v, s in found] + missing)


def rays(folder):
    rows = rows_of(folder, "rays")
    by_clock, by_processor = over_best(rows, "milliseconds"), over_best(rows, "processor_milliseconds")
    yield "<p>Millions of rays a second, by the clock; the last table has builds. A tracer has all cores. %s</p>" % (
        "NAME:best is a peer with its best setting. Only tracers that find the same number of hits, within 0.1 %, are timed.")
    if by_clock:
        yield table(["geometric mean, claray over the best peer of each scene", *by_clock],
                    [["by the clock", *(short(mean(r)) for r in by_clock.values())],
                     ["by processor time", *(short(mean(by_processor[kind])) for kind in by_clock)]])
        yield bars("claray over the best peer of each scene, by the clock; 1 is equal",
                   [("%s, %s" % (kind, scene), ratio, ratio >= 1) for kind in KINDS for scene, ratio in by_clock.get(kind, {}).items()])
    for kind in KINDS:
        yield "<h3>%s rays</h3>" % kind.capitalize() + speeds(rows, kind, "milliseconds", by_clock)
        yield "<details><summary>%s rays a second of processor time, in millions</summary>%s</details>" % (
            kind.capitalize(), speeds(rows, kind, "processor_milliseconds", by_processor))
    yield "<h3>Builds, in millions of triangles a second</h3><p>From arrays to a tree that answers, as each library is called from Python.</p>"
    yield speeds(rows, "build", "milliseconds", by_clock)
    yield "<h3>Tracers</h3>" + settings(rows)


# ---- the other sections

def hard(folder):
    rows = rows_of(folder, "hard")
    titles = {"hits": "Closest hits", "occlusion": "Occlusion", "counts": "All hits", "distances": "Distances of points", "signs": "Sides of points"}
    yield "<p>Wrong answers to rays and points whose exact answers are known. Smaller is better; <code>-</code>: the tracer cannot be asked.</p>"
    totals = {}
    for row in rows:
        if row["table"] == "hits" and row["wrong"][:1].isdigit():
            totals[row["tracer"]] = totals.get(row["tracer"], 0) + int(row["wrong"].split()[0])
    yield bars("Wrong closest hits of all cases", [(t, n + 1, t == "claray") for t, n in sorted(totals.items(), key=lambda x: x[1])], less=1)
    for kind in unique(r["table"] for r in rows):
        here = [r for r in rows if r["table"] == kind]
        tracers, found = unique(r["tracer"] for r in here), {(r["case"], r["tracer"]): r["wrong"] for r in here}
        command = "python3 bench/hardrays/run.py --only %s --tracer %s"
        lines = [[case, *((found.get((case, t), ""), command % (case, t), "best" if found.get((case, t)) == "0" else "") for t in tracers)]
                 for case in unique(r["case"] for r in here)]
        yield "<h3>%s</h3>" % titles.get(kind, kind) + table(["case", *(t.replace("_", " ") for t in tracers)], lines)


SETTINGS = {"mitsuba": " with its sampler multijitter; its default is the sampler independent",
            "cycles": ", whose default settings clamp light: here nothing biases the picture"}


def render(peer):
    def section(folder):
        rows = rows_of(folder, peer)
        yield "<p>Efficiency is 1 / (squared error x seconds of sampling), over that of %s%s.</p>" % (peer.capitalize(), SETTINGS[peer])
        ours = [r for r in rows if r["setting"] == "default"]
        yield bars("claray over %s, by the clock" % peer.capitalize(), [(r["scene"], number(r["efficiency_by_clock"]), True) for r in ours])
        command = "python3 bench/renderers/efficiency.py build/bin/claray %s --defaults --size %s --spp %s --seeds 3 --peer %s"
        lines = []
        for r in rows:
            name, tip = "claray" if r["setting"] == "default" else r["setting"], command % (r["scene"], r["size"], r["spp"], peer)
            values = [short(number(r[key])) for key in ("squared_error", "clock_seconds", "efficiency_by_clock", "efficiency_by_processor")]
            lines.append([r["scene"], name, *((v, tip, "") for v in values), (r["mean"], tip, "")])
        yield table(["scene", "renderer", "squared error", "seconds", "efficiency by the clock", "by processor time", "mean radiance"], lines)
    return section


def cold(folder):
    rows = rows_of(folder, "cold")
    yield "<p>Seconds from the start of a process to its first answer: 100,000 rays in 101,250 triangles, or a picture of <code>cornell</code>.</p>"
    items = [("%s, %s caches" % (r["program"], r["caches"]), number(r["seconds"]), r["program"].startswith("claray")) for r in rows]
    yield bars("Seconds", items, " s")
    both = {}
    for r in rows:
        both.setdefault((r["task"], r["program"]), {})[r["caches"]] = (r["seconds"] or r["note"], r["command"], "")
    yield table(["task", "program", "empty caches", "full caches"], [[*key, found.get("empty", ""), found.get("full", "")] for key, found in both.items()])


SECTIONS = {"rays": ("Rays a second", rays), "hard": ("Hard cases", hard), "mitsuba": ("Error against time: Mitsuba", render("mitsuba")),
            "cycles": ("Error against time: Cycles", render("cycles")), "cold": ("Cold starts", cold)}


def section_of(line, folder):
    title, body = SECTIONS.get(line["name"], (line["name"], lambda folder: ()))
    note = '<p class="note">This section %s.</p>' % text(line["note"]) if line["note"] else ""
    parts = "" if line["note"] and not rows_of(folder, line["name"]) else "".join(body(folder))
    return "<h2>%s</h2><p><code>%s</code> (%s s)</p>%s%s" % (text(title), text(line["command"]), line["seconds"], note, parts)


def write(folder):
    facts = rows_of(folder, "facts")
    known = {row["fact"]: row["value"] for row in facts}
    sections = "".join(section_of(line, folder) for line in rows_of(folder, "sections"))
    head = "<h1>claray beside its peers</h1><p>%s, %s. <code>./dev league</code> made this page. %s</p>" % (
        text(known.get("device", "")), text(known.get("date", "")),
        "Rest the pointer on a cell to see its command, which wants the Python of <code>build/league_env</code> and "
        "<code>PYTHONPATH=build/python</code>.")
    versions = "<h2>Machine and versions</h2>" + table(["", ""], [(r["fact"], (r["value"], "", "text")) for r in facts])
    Path(folder, "index.html").write_text('<!doctype html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">'
                                          "<title>claray beside its peers</title><style>%s</style>%s%s%s</html>\n" % (STYLE, head, sections, versions))


if __name__ == "__main__":
    write(sys.argv[1])
