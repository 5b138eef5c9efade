"""The league (bench/league): a peer that aborts, hangs, is missing or finds other hits is reported so, and the others are measured."""

import csv
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

LEAGUE = Path(__file__).resolve().parents[2] / "bench/league"
sys.path.insert(0, str(LEAGUE))

import page  # noqa: E402
import rays as league_rays  # noqa: E402

# Peers that fail in their own ways; any other name is that of a real tracer.
WORKER = """
import json, os, runpy, sys, time

name = sys.argv[1]
if name not in ("aborting", "hanging", "wrong"):
    runpy.run_path(%r, run_name="__main__")
    sys.exit()
print(json.dumps({"version": "1", "best": ""}), flush=True)
for line in sys.stdin:
    if line.startswith("prepare"):
        if name == "aborting":
            os.abort()
        if name == "hanging":
            time.sleep(1e6)
    print(json.dumps({"hits": 7, "seconds": 1, "processor": 1}), flush=True)
"""


@pytest.fixture
def worker(tmp_path):
    path = tmp_path / "worker.py"
    path.write_text(WORKER % str(LEAGUE / "ray_worker.py"))
    return path


def run_league(out, *options):
    command = [sys.executable, str(LEAGUE / "league.py"), "--device", "some-device", "--out", str(out), *options]
    return subprocess.run(command, capture_output=True, text=True)


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def test_a_peer_that_fails_is_named_and_claray_is_measured(tmp_path, worker):
    section = f"{LEAGUE}/rays.py --scene hall --tracer claray aborting absent --side 24 --rounds 2 --limit 1000 --worker {worker}"
    ran = run_league(tmp_path / "out", "--only", "rays", "--section", "rays", section)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    rows = rows_of(tmp_path / "out/rays.csv")
    of = lambda name: {r["kind"]: r for r in rows if r["tracer"] == name}
    assert list(of("claray")) == ["build", "primary", "shadow", "bounce", "random"]
    for kind, row in of("claray").items():
        assert float(row["millions_per_second"]) > 0 and not row["note"], row
        assert float(row["millions_per_second"]) == pytest.approx(int(row["count"]) / float(row["milliseconds"]) / 1e3, rel=0.02, abs=1e-3)
    assert int(of("claray")["primary"]["count"]) == 24 * 24
    assert {r["note"] for kind, r in of("aborting").items() if kind != "build"} == {"aborts"}
    assert "left out" in next(r["note"] for r in rows if r["tracer"] == "absent")
    written = (tmp_path / "out/index.html").read_text()
    for text in ("some-device", "aborts", "left out", of("claray")["primary"]["command"]):
        assert text in written, text


def test_a_section_that_fails_is_named_and_nothing_is_half_written(tmp_path):
    ran = run_league(tmp_path / "out", "--only", "broken", "cold", "--section", "broken", "nowhere.py", "--section", "cold",
                     f"{LEAGUE}/cold.py --only claray --rounds 1")
    assert ran.returncode == 1, ran.stdout + ran.stderr
    notes = {row["name"]: row["note"] for row in rows_of(tmp_path / "out/sections.csv")}
    assert "exit code 2" in notes["broken"] and notes["cold"] == ""
    assert [row["caches"] for row in rows_of(tmp_path / "out/cold.csv") if float(row["seconds"]) > 0] == ["empty", "full"]
    written = (tmp_path / "out/index.html").read_text()
    assert "fails with exit code 2" in written and "<svg" in written
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out"]


def test_a_peer_that_hangs_is_ended_and_begins_anew(tmp_path, worker):
    options = SimpleNamespace(limit=1000, worker=str(worker), tinybvh="")
    hanging, other = (league_rays.Tracer(name, str(tmp_path), options) for name in ("hanging", "wrong"))
    hanging.options = SimpleNamespace(**dict(vars(options), limit=0.2))
    for tracer in (hanging, other):
        tracer.load("scene")
    rows = list(league_rays.measure("scene", "primary", 100, [hanging, other], 2))
    assert [(row[2].name, row[3], row[5]) for row in rows] == [("hanging", None, "hangs"), ("wrong", 1000, "")]
    first, hanging.options = hanging.process, options
    hanging.load("another")
    assert hanging.process is not first and not hanging.note
    hanging.end(), other.end()


def test_no_tracer_is_timed_on_other_hits():
    note = league_rays.note_disagreement
    assert list(note({"a": 5000, "b": 5004, "c": 4990}, 5000)) == ["c"]
    assert list(note({"a": 5000, "b": 4990}, 5000)) == ["a", "b"]
    assert not note({"a": 5000}, 5000) and not note({}, 5000)


def test_the_ratio_is_over_the_best_peer():
    row = lambda tracer, took: dict(scene="a", kind="primary", count="1000000", tracer=tracer, milliseconds=took)
    ratios = page.over_best([row("claray", "100"), row("x", "300"), row("y", "200"), row("z", "")], "milliseconds")
    assert ratios == {"primary": {"a": 2.0}}
