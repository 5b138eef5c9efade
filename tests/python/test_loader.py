"""Drivers that pip installed are found beside those of the system (claray/_loader.py)."""

import importlib
import os
import sys
import tempfile

import pytest

import claray  # noqa: F401

loader = importlib.import_module("claray._loader")
KEY = "OCL_ICD_VENDORS"


@pytest.fixture
def machine(tmp_path, monkeypatch):
    """A system with PoCL, and an environment of Python with Intel's runtime."""
    for name in (KEY, "OCL_ICD_FILENAMES", "OPENCL_VENDOR_PATH", "CLARAY_CACHE_DIR"):
        monkeypatch.delenv(name, raising=False)
    system, prefix = tmp_path / "vendors", tmp_path / "env"
    system.mkdir(), (prefix / "lib").mkdir(parents=True)
    (system / "pocl.icd").write_text("libpocl.so.2\n")
    (prefix / "lib/libintelocl.so").touch()
    monkeypatch.setattr(loader, "_SYSTEM", str(system))
    monkeypatch.setattr(sys, "prefix", str(prefix))
    monkeypatch.setattr(loader.site, "getuserbase", lambda: str(tmp_path / "none"))
    monkeypatch.setattr(loader.sysconfig, "get_path", lambda name: str(prefix))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    yield tmp_path
    os.environ.pop(KEY, None)


def registered():
    folder = os.environ[KEY]
    return {name: open(os.path.join(folder, name)).read().strip() for name in os.listdir(folder)}


def test_both_are_registered_in_one_folder(machine):
    loader._register_drivers()
    assert registered() == {"pocl.icd": "libpocl.so.2", "pip-0.icd": str(machine / "env/lib/libintelocl.so")}
    folder = os.environ.pop(KEY)
    assert folder.startswith(str(machine / "cache/claray"))
    loader._register_drivers()
    assert os.environ[KEY] == folder, "made once"
    assert len(os.listdir(machine / "cache/claray")) == 1


def test_a_folder_that_lacks_files_is_made_again(machine):
    loader._register_drivers()
    folder = os.environ.pop(KEY)
    os.remove(os.path.join(folder, "pocl.icd"))
    loader._register_drivers()
    assert os.environ[KEY] == folder and sorted(registered()) == ["pip-0.icd", "pocl.icd"]


def test_nothing_is_set_where_no_folder_can_be_written(machine, monkeypatch):
    (machine / "file").touch()
    monkeypatch.setenv("CLARAY_CACHE_DIR", str(machine / "file/cache"))
    monkeypatch.setattr(tempfile, "tempdir", str(machine / "file"))
    loader._register_drivers()
    assert KEY not in os.environ


def test_what_the_user_set_stays(machine, monkeypatch):
    monkeypatch.setenv(KEY, "/mine")
    loader._register_drivers()
    assert os.environ[KEY] == "/mine"
    monkeypatch.delenv(KEY)
    monkeypatch.setenv("OCL_ICD_FILENAMES", "mine.so")
    loader._register_drivers()
    assert KEY not in os.environ


def test_drivers_of_the_system_are_not_registered_twice(machine):
    (machine / "libintelocl.so").touch()
    (machine / "vendors/intel.icd").write_text(f"{machine / 'libintelocl.so'}\n")
    loader._register_drivers()
    assert KEY not in os.environ


def test_nothing_is_set_without_a_driver_of_pip(machine):
    (machine / "env/lib/libintelocl.so").unlink()
    loader._register_drivers()
    assert KEY not in os.environ


def test_a_cache_that_cannot_be_written_is_replaced(machine, monkeypatch):
    (machine / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(machine / "file"))
    loader._register_drivers()
    assert sorted(registered()) == ["pip-0.icd", "pocl.icd"]
