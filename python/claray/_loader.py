"""Finds an OpenCL loader, and drivers that pip installed, before the extension module is loaded."""

from __future__ import annotations

import ctypes
import glob
import os
import site
import sys
import sysconfig

_SYSTEM = "/etc/OpenCL/vendors"  # where the drivers of a system are registered
_LOADER = "libOpenCL.so.1"
_DRIVERS = ("lib/libintelocl.so",)  # of PyPI's intel-opencl-rt


def _load_loader() -> bool:
    """The system's loader, else that of the wheel. The extension module then finds it by its name. Returns whether it is the wheel's."""
    for path in (_LOADER, os.path.join(os.path.dirname(__file__), "loader", _LOADER)):
        try:
            ctypes.CDLL(path, mode=ctypes.RTLD_GLOBAL)
            return path != _LOADER
        except OSError:
            pass
    return False


def _register_drivers() -> None:
    """Lets the loader find drivers that pip installed, beside the system's. What the user has set stays as it is."""
    if any(name in os.environ for name in ("OCL_ICD_VENDORS", "OCL_ICD_FILENAMES", "OPENCL_VENDOR_PATH")):
        return
    system = _read_system()
    ours = [path for path in _installed() if not any(os.path.basename(path) in text for text in system.values())]
    if ours:
        try:
            os.environ["OCL_ICD_VENDORS"] = _folder({**system, **{f"pip-{k}.icd": path for k, path in enumerate(ours)}})
        except OSError:  # no folder can be written: the system's drivers remain
            pass


def _installed() -> list[str]:
    prefixes = dict.fromkeys([sys.prefix, sysconfig.get_path("data"), site.getuserbase()])
    return [path for prefix in prefixes for driver in _DRIVERS if os.path.exists(path := os.path.join(prefix, driver))]


def _read_system() -> dict[str, str]:
    texts: dict[str, str] = {}
    for folder in (_SYSTEM, os.path.join(sys.prefix, "etc/OpenCL/vendors")):  # the latter in an environment of conda
        for path in sorted(glob.glob(os.path.join(folder, "*.icd"))):
            try:
                with open(path, encoding="utf-8") as file:
                    text = file.read().strip()
            except (OSError, UnicodeDecodeError):
                continue
            if not text.startswith("/") or os.path.exists(text):  # a package of PyPI registers a path of its maker's machine
                texts.setdefault(os.path.basename(path), text)
    return texts


def _cache() -> str | None:
    """As the library: $CLARAY_CACHE_DIR, $XDG_CACHE_HOME/claray or ~/.cache/claray."""
    if own := os.environ.get("CLARAY_CACHE_DIR"):
        return own
    shared, home = os.environ.get("XDG_CACHE_HOME", ""), os.environ.get("HOME", "")
    if os.path.isabs(shared):
        return os.path.join(shared, "claray")
    return os.path.join(home, ".cache/claray") if os.path.isabs(home) else None


def _folder(texts: dict[str, str]) -> str:
    """A folder of .icd files in the cache, since a loader reads only one folder. Made once for the same drivers."""
    import atexit  # these take milliseconds, and most systems have no driver of pip
    import hashlib
    import shutil
    import tempfile

    name = "drivers-" + hashlib.sha256(repr(sorted(texts.items())).encode()).hexdigest()[:16]
    cache = _cache()
    folder = os.path.join(cache, name) if cache else ""
    if cache and os.path.isdir(folder) and set(os.listdir(folder)) == set(texts):
        return folder
    try:
        if not cache:
            raise OSError("no cache")
        os.makedirs(cache, exist_ok=True)
        made = tempfile.mkdtemp(dir=cache)
    except OSError:  # no home, or a full disk
        folder = made = tempfile.mkdtemp(prefix="claray-")
        atexit.register(_remove, made, os.getpid())
    for file, text in texts.items():
        with open(os.path.join(made, file), "w", encoding="utf-8") as to:
            to.write(text + "\n")
    if made != folder:
        shutil.rmtree(folder, ignore_errors=True)  # if a cleaner took some of its files
        try:
            os.rename(made, folder)
        except OSError:  # another process was faster
            shutil.rmtree(made, ignore_errors=True)
    return folder


def _remove(folder: str, owner: int) -> None:
    if os.getpid() == owner:  # not in a forked process
        import shutil

        shutil.rmtree(folder, ignore_errors=True)


of_wheel = _load_loader()
_register_drivers()
