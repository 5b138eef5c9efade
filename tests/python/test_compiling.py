"""Compiling ahead, and what is said of it."""

import os
import subprocess
import sys

import pytest

import claray

BUILD = """
import numpy, sys, claray
{before}
claray.Bvh(numpy.eye(3), [[0, 1, 2]], builder="fast", layout="binary")
"""


def said(folder, before=""):
    """Standard error of a process that builds a structure with a cache of its own."""
    environment = {**os.environ, "CLARAY_CACHE_DIR": str(folder)}
    return subprocess.run([sys.executable, "-c", BUILD.format(before=before)], env=environment, check=True,
                          capture_output=True, text=True).stderr


def test_what_is_compiled_is_said_at_once(tmp_path):
    first = said(tmp_path)
    assert first.startswith("claray: compiling 1 of ") and "kernels, once for this device\n" in first
    assert said(tmp_path) == "", "the cache has them"


def test_nothing_is_said_if_not_wanted(tmp_path):
    assert said(tmp_path, "claray.tell_compiling(False)") == ""


def test_prepare_compiles_for_a_scene():
    scene = claray.load("cornell")
    claray.prepare(scene, denoise="claray", max_depth=2)
    with pytest.raises(claray.UsageError, match="need a scene"):
        claray.prepare(denoise=True)


def test_kernels_of_effects_are_compiled():
    effects = claray.load("cornell").effects()
    claray.compile_kernels(list(effects), width=8, height=8, spp=1)
    claray.compile_kernels(",".join(effects), width=8, height=8, spp=1)
    with pytest.raises(claray.UsageError, match="^effects: there is no effect 'lambda'"):
        claray.compile_kernels("lambda")
