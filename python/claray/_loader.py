"""Finds an OpenCL loader, and drivers that pip installed, before the extension module is loaded."""

import ctypes
import glob
import hashlib
import os
import site
import sys
import tempfile

_SYSTEM = "/etc/OpenCL/vendors"  # where the drivers of a system are registered
_LOADER = "libOpenCL.so.1"
_DRIVERS = ("lib/libintelocl.so",)  # of PyPI's intel-opencl-rt


def _load_loader() -> None:
    """The system's loader, else that of the wheel. The extension module then finds it by its name."""
    for path in (_LOADER, os.path.join(os.path.dirname(__file__), "loader", _LOADER)):
        try:
            ctypes.CDLL(path, mode=ctypes.RTLD_GLOBAL)
            return
        except OSError:
            pass


def _register_drivers() -> None:
    """Lets the loader find drivers that pip installed, beside the system's. What the user has set stays as it is."""
    if "OCL_ICD_VENDORS" in os.environ or "OCL_ICD_FILENAMES" in os.environ:
        return
    system = _read_system()
    ours = [path for path in _installed() if not any(os.path.basename(path) in text for text in system.values())]
    if ours:
        os.environ["OCL_ICD_VENDORS"] = _folder({**system, **{f"pip-{k}.icd": path for k, path in enumerate(ours)}})


def _installed() -> list[str]:
    prefixes = dict.fromkeys([sys.prefix, site.getuserbase()])
    return [path for prefix in prefixes for driver in _DRIVERS if os.path.exists(path := os.path.join(prefix, driver))]


def _read_system() -> dict[str, str]:
    texts = {}
    for path in sorted(glob.glob(os.path.join(_SYSTEM, "*.icd"))):
        try:
            with open(path, encoding="utf-8") as file:
                texts[os.path.basename(path)] = file.read().strip()
        except (OSError, UnicodeDecodeError):
            pass
    return texts


def _folder(texts: dict[str, str]) -> str:
    """A folder of .icd files in the cache, since a loader reads only one folder. Made once for the same drivers."""
    cache = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    name = "drivers-" + hashlib.sha256(repr(sorted(texts.items())).encode()).hexdigest()[:16]
    folder = os.path.join(cache, "claray", name)
    if os.path.isdir(folder):
        return folder
    try:
        os.makedirs(os.path.dirname(folder), exist_ok=True)
        made = tempfile.mkdtemp(dir=os.path.dirname(folder))
    except OSError:  # no home, or a full disk
        made = folder = tempfile.mkdtemp(prefix="claray-")
    for file, text in texts.items():
        with open(os.path.join(made, file), "w", encoding="utf-8") as to:
            to.write(text + "\n")
    if made != folder:
        try:
            os.rename(made, folder)
        except OSError:  # another process was faster
            folder = folder if os.path.isdir(folder) else made
    return folder


_load_loader()
_register_drivers()
