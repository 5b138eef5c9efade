"""Rays a second and builds of claray and its peers, on the same meshes and rays, by turns.

    python3 bench/league/rays.py [--scene NAME...] [--kind KIND...] [--tracer NAME...] [--files FOLDER] [--csv FILE]

Each tracer is a process of its own, which converts mesh and rays to its own types before the clock starts. NAME:best is a peer with
its best setting. A tracer that is not installed, aborts, hangs, or finds other numbers of hits has a note instead of a speed.
"""

import argparse
import csv
import os
import statistics
import sys
import tempfile

FOLDER = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [FOLDER, os.path.join(FOLDER, "../hardrays")]

import page  # noqa: E402
from process import Process  # noqa: E402
from ray_scenes import KINDS, known, write  # noqa: E402

TRACERS = ("claray", "embreex", "embreex:best", "mitsuba", "mitsuba:best", "open3d", "warp", "warp:best", "tinybvh", "tinybvh:best")
COLUMNS = ("scene", "triangles", "kind", "count", "tracer", "version", "setting", "milliseconds", "processor_milliseconds", "millions_per_second",
           "note", "command")
DISAGREE = 1e-3  # of the rays: more is another answer
PATIENCE = 8  # seconds of a tracer's turns, after which three of them are enough


class Tracer:
    """A tracer's process, made anew after it stopped."""

    def __init__(self, name, folder, options):
        self.name, self.folder, self.options = name, folder, options
        self.process, self.note = None, ""
        self.start()

    def start(self):
        program, _, setting = self.name.partition(":")
        environment = dict(os.environ, LEAGUE_SETTING=setting, HARDRAYS_TINYBVH=self.options.tinybvh)
        command = [sys.executable, self.options.worker, program, self.folder]
        self.process = Process(command, os.path.join(self.folder, self.name.replace(":", "_") + ".log"), environment)
        about = self.process.next(self.options.limit)
        self.note = about.get("stopped", "")
        self.missing, self.version, self.best = about.get("missing", self.note), about.get("version", ""), about.get("best", "")

    def load(self, scene):
        """Begins a scene, and forgets what stopped the tracer in another."""
        if self.note and not self.missing:
            self.end()
            self.start()
        self.ask("load " + scene)

    def ask(self, question):
        """The answer, or nothing once the tracer stopped."""
        if self.note or self.missing:
            return {}
        answer = self.process.ask(question, self.options.limit)
        self.note = answer.get("stopped", "")
        return {} if self.note else answer

    def end(self):
        self.process.end()


def by_turns(tracers, question, rounds):
    """Each tracer's times, as milliseconds by the clock and of processors."""
    times = {tracer: [] for tracer in tracers}
    for _ in range(rounds):
        for tracer in tracers:
            if len(times[tracer]) < 3 or sum(x.get("seconds", 0) for x in times[tracer]) < PATIENCE:
                times[tracer].append(tracer.ask(question))
    return {t: [1e3 * statistics.median(x[key] for x in found) for key in ("seconds", "processor")]
            for t, found in times.items() if not t.note and not t.missing}


def note_disagreement(hits, count):
    """Tracers whose hits are not those that more than half of them find; all of them, if no half agrees."""
    agree = lambda n: [m for m in hits.values() if abs(m - n) <= DISAGREE * count]
    usual = max(hits.values(), key=lambda n: len(agree(n)), default=0)
    most = 2 * len(agree(usual)) > len(hits)
    return {t: "%d hits, not %s" % (n, usual if most else "as others") for t, n in hits.items() if not most or n not in agree(usual)}


def measure(scene, kind, count, tracers, rounds):
    """Rows of a scene's kind of rays, or of its builds."""
    if kind == "build":
        tracers_of_turns, wrong = tracers, {}
    else:
        answers = {t: t.ask("prepare " + kind) for t in tracers}
        hits = {t: answer["hits"] for t, answer in answers.items() if answer}
        wrong = note_disagreement(hits, count)
        tracers_of_turns = [t for t in tracers if t not in wrong]
    times = by_turns(tracers_of_turns, "build" if kind == "build" else "trace", rounds)
    for tracer in tracers:
        clock, processor = times.get(tracer, (None, None))
        yield [kind, count, tracer, clock, processor, wrong.get(tracer) or tracer.note]


def command_of(scene, kind, tracer, options):
    words = ["python3 bench/league/rays.py --scene", scene, "--kind", kind, "--tracer claray" + ("" if tracer == "claray" else " " + tracer)]
    words += ["--files FOLDER"] if scene + ".obj" in os.listdir(options.files or ".") else []
    return " ".join(words + (["--tinybvh FOLDER"] if tracer.startswith("tinybvh") else []))


def rows_of(scene, tracers, options, folder):
    made = known(options.files)[scene]()
    os.mkdir(os.path.join(folder, scene))
    counts, triangles = write(made, options.side, os.path.join(folder, scene)), len(made[1])
    for tracer in tracers:
        tracer.load(scene)
    by_turns(tracers, "build", 1)  # compiles
    for kind in options.kind:
        count = triangles if kind == "build" else counts[kind]
        for _, _, tracer, clock, processor, note in measure(scene, kind, count, tracers, options.rounds):
            times = ["%.3f" % clock, "%.3f" % processor, "%.3f" % (count / clock / 1e3)] if clock else ["", "", ""]
            setting = tracer.best if ":best" in tracer.name else "default"
            yield [scene, triangles, kind, count, tracer.name, tracer.version, setting, *times, note, command_of(scene, kind, tracer.name, options)]


def print_means(rows):
    """Geometric means over scenes of claray's speed over the best peer's."""
    rows = [dict(zip(COLUMNS, row)) for row in rows]
    by_clock, by_processor = (page.over_best(rows, key) for key in ("milliseconds", "processor_milliseconds"))
    for kind, ratios in by_clock.items():
        print("claray over the best peer: %s %.3f by the clock, %.3f by processor time" % (kind, page.mean(ratios), page.mean(by_processor[kind])))


def options_of_command_line():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", nargs="+", metavar="NAME", help="[all]")
    parser.add_argument("--tracer", nargs="+", metavar="NAME", default=TRACERS, help="[%s]" % " ".join(TRACERS))
    parser.add_argument("--kind", nargs="+", choices=("build", *KINDS), default=("build", *KINDS), help="[all]")
    parser.add_argument("--files", help="a folder with sponza.obj, sibenik.obj, bunny.obj or igea.obj, which add scenes")
    parser.add_argument("--side", type=int, default=512, help="rays are this number squared [512]")
    parser.add_argument("--rounds", type=int, default=9, help="[9]")
    parser.add_argument("--limit", type=float, default=60, help="seconds for one answer of a tracer [60]")
    parser.add_argument("--tinybvh", default="", help="a folder with tinybvh's tiny_bvh.h")
    parser.add_argument("--worker", default=os.path.join(FOLDER, "ray_worker.py"), help=argparse.SUPPRESS)
    parser.add_argument("--csv")
    options = parser.parse_args()
    unknown = set(options.scene or ()) - set(known(options.files))
    if unknown:
        parser.error("unknown scene %s; choose from %s" % (unknown.pop(), " ".join(known(options.files))))
    return options


def main():
    options = options_of_command_line()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        tracers = [Tracer(name, folder, options) for name in options.tracer]
        for tracer in [t for t in tracers if t.missing]:
            print("%s is left out: %s" % (tracer.name, tracer.missing))
            rows.append(["", "", "", "", tracer.name, "", "", "", "", "", "left out: " + tracer.missing, ""])
        there = [t for t in tracers if not t.missing]
        for scene in options.scene or known(options.files):
            for row in rows_of(scene, there, options, folder):
                rows.append(row)
                print("%-10s %-8s %-14s %8s millions a second %s" % (row[0], row[2], row[4], row[9], row[10]), flush=True)
        for tracer in tracers:
            tracer.end()
    print_means(rows)
    if options.csv:
        with open(options.csv, "w", newline="") as file:
            csv.writer(file).writerows([COLUMNS, *rows])


if __name__ == "__main__":
    main()
