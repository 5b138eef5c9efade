"""Processes and threads, and that structures which are dropped leave no memory behind."""

import concurrent.futures
import gc
import multiprocessing
import os
import signal
import subprocess
import sys
import weakref

import numpy as np
import pytest

import claray

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32)
DOWN = ([[0.2, 0.2, 1.0]], [[0, 0, -1.0]])


def hit_distance(height):
    """For processes: builds a structure of its own."""
    bvh = claray.Bvh(CORNERS - [0, 0, height], [[0, 1, 2]])
    return float(claray.closest_hit(bvh, *DOWN)["t"][0])


def after_fork(act):
    """Runs `act` in a process made by fork; returns its exit code and what it printed."""
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        signal.alarm(60)  # without the remedy, calls would wait without end
        try:
            act()
            os.write(write, b"nothing was raised")
        except claray.UsageError as error:
            os.write(write, str(error).encode())
        finally:
            os._exit(7)
    os.close(write)
    with os.fdopen(read) as pipe:
        text = pipe.read()
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), text


def test_use_after_fork_is_refused_and_ends(soup, rays):
    bvh, cornell = soup[2], claray.load("cornell")
    renderer = claray.Renderer(cornell, width=8, height=8, spp=1)
    renderer.image()
    query = claray.Query(bvh, queue=bvh.device.with_new_queue())
    query(*rays)
    uses = [lambda: claray.any_hit(bvh, *rays), lambda: query(*rays), lambda: hit_distance(1), lambda: claray.Device(),
            lambda: claray.devices(), lambda: bvh.statistics(), lambda: claray.nearest_point(bvh, rays[0]),
            lambda: claray.all_hits(bvh, *rays), lambda: renderer.image(), lambda: claray.render(cornell, width=8, height=8),
            lambda: bvh.device.finish(), lambda: bvh.refit(soup[0]), lambda: claray.verify(["sort"])]
    for use in uses:
        code, text = after_fork(use)
        assert code == 7 and "spawn" in text and "fork" in text
    assert claray.any_hit(bvh, *rays).any()  # the parent goes on


def test_forked_processes_end_by_themselves():
    """They release all objects, and run what is registered at their end."""
    program = """
import os, sys, claray
claray.tell_compiling(False)
bvh = claray.Bvh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
claray.any_hit(bvh, [[0, 0, 1]], [[0, 0, -1]])
child = os.fork()
if child == 0:
    del bvh
    sys.exit(5)
print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""
    done = subprocess.run([sys.executable, "-W", "ignore::DeprecationWarning", "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == "5\n" and done.stderr == ""


def test_fork_before_the_first_use_is_fine():
    program = """
import os, claray
claray.tell_compiling(False)
child = os.fork()
bvh = claray.Bvh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
print(claray.any_hit(bvh, [[0.2, 0.2, 1]], [[0, 0, -1]]), flush=True)
if child:
    os.waitpid(child, 0)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == "[ True]\n[ True]\n" and done.stderr == ""


def test_errors_of_forked_workers_reach_the_parent():
    claray.default_device()
    with concurrent.futures.ProcessPoolExecutor(1, multiprocessing.get_context("fork")) as pool:
        with pytest.raises(claray.UsageError, match="spawn"):
            pool.submit(hit_distance, 1).result()


def test_spawned_processes_work():
    with concurrent.futures.ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as pool:
        assert list(pool.map(hit_distance, range(4))) == [1, 2, 3, 4]


def test_threads_build_and_ask(soup, rays):
    bvh = soup[2]
    expected = claray.closest_hit(bvh, *rays)

    def work(number):
        own = claray.Bvh(soup[0] + np.float32(number), soup[1])
        moved = claray.closest_hit(own, rays[0] + np.float32(number), rays[1])
        shared = claray.closest_hit(bvh, *rays)
        return (shared == expected).all() and (moved["primitive"] == expected["primitive"]).mean() > 0.99

    with concurrent.futures.ThreadPoolExecutor(8) as pool:
        assert all(pool.map(work, range(24)))


def resident_megabytes():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


def test_a_thousand_structures_leave_no_memory():
    """Without the garbage collector: nothing that is asked holds itself. One of these takes 0.7 MB."""
    trimesh = pytest.importorskip("trimesh")
    ball = trimesh.creation.icosphere(subdivisions=4)
    gc.disable()
    try:
        for i in range(1000):
            bvh = claray.Bvh(ball.vertices, ball.faces)
            claray.closest_hit(bvh, *DOWN)
            claray.any_hit(bvh, *DOWN)
            claray.all_hits(bvh, *DOWN)
            claray.inside(bvh, DOWN[0])
            dropped = weakref.ref(bvh)
            del bvh
            assert dropped() is None
            if i == 200:
                early = resident_megabytes()
        assert resident_megabytes() < early + 30
    finally:
        gc.enable()


def test_other_structures_leave_with_their_queries(soup, rays):
    gc.disable()
    try:
        for make in (lambda: claray.InstancedBvh(soup[2], np.eye(4)[None]), lambda: claray.Primitives.spheres(np.eye(3), 0.5)):
            structure = make()
            claray.closest_hit(structure, *rays)
            query = claray.Query(structure)
            dropped = weakref.ref(structure)
            del structure
            assert dropped() is None
            query(*rays)  # which keeps what it traces
    finally:
        gc.enable()
