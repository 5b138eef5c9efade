"""Tests packages of Debian: lintian finds nothing, and a bare system that installs them as Containerfile does renders.

    python3 tests/install/packages.py FOLDER SYSTEMS
    python3 tests/install/packages.py --can          only tells by the exit code whether this system can

FOLDER: of the packages, as ./dev deb makes them. SYSTEMS: a folder for bare systems, which are kept. Needs root, lintian, mmdebstrap and
Debian's mirror. The exit code is 77 if this system cannot make another.
"""

import pathlib
import re
import shutil
import subprocess
import sys

from bare_system import BareSystem, cannot_try, require_tools

ROOT = pathlib.Path(__file__).resolve().parents[2]
CONSUMER = ROOT / "tests/install/consumer"


def installing():
    """The commands of Containerfile's last stage, which install the packages of /packages."""
    last = (ROOT / "Containerfile").read_text().split("\nFROM ")[-1]
    return [line.removeprefix("RUN ") for line in last.splitlines() if line.startswith("RUN ")]


def lint(packages):
    """What lintian finds, but for two things: a first upload to Debian closes a bug that asks for the package, and CPack itself writes
    scripts that call ldconfig."""
    told = subprocess.run(["lintian", "--allow-root", "--suppress-tags", "initial-upload-closes-no-bugs,maintscript-calls-ldconfig",
                           *packages], stdout=subprocess.PIPE, text=True)
    return told.stdout.splitlines() or ([f"lintian ended with {told.returncode}"] if told.returncode else [])


def check_program(system):
    """Returns what is wrong with the installed program, alone and with MPI."""
    wrong = []
    told = system.run("cd /tmp && claray render cornell -o cornell.png --size 32x32 --spp 4")
    if not re.search(r"cornell.png: 32x32, 4 spp", told):
        wrong.append(f"claray render: {told}")
    system.run("OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 mpirun --oversubscribe -n 2 "
               "claray render cornell -o /tmp/two.png --size 32x32 --spp 4 -q")
    system.put("scenes", [ROOT / "tests/io/assimp/files/square.off"])
    told = system.run("claray render /scenes/square.off -o /tmp/square.png --size 32x32 --spp 4")
    if not re.search(r"square.png: 32x32, 4 spp", told):
        wrong.append(f"claray render of an OFF: {told}")
    libraries = system.run("ldd /usr/bin/claray").splitlines()
    if len(libraries) > 20:
        wrong.append(f"claray loads {len(libraries)} libraries")
    if "not found" in system.run("ldd /usr/lib/*/claray/*.so"):
        wrong.append("a plugin lacks a library")
    return wrong


def check_development(system):
    """Returns what is wrong with programs in C and C++ that are built with the packages."""
    system.put("consumer", CONSUMER.iterdir())
    system.run("apt-get install -y --no-install-recommends g++ cmake pkg-config make")
    system.run("cc -std=c99 /consumer/main.c -o /consumer/in_c $(pkg-config --cflags --libs claray) && /consumer/in_c")
    system.run("cmake -S /consumer -B /consumer/build && cmake --build /consumer/build && /consumer/build/consumer")
    needed = system.run("readelf -d /consumer/build/consumer")
    return [] if "libclaray.so.0" in needed else [f"the consumer does not need libclaray.so.0: {needed}"]


def main():
    require_tools()
    if not shutil.which("lintian"):
        cannot_try("lintian is missing: apt-get install lintian")
    if sys.argv[1:] == ["--can"]:
        return
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    packages = sorted(pathlib.Path(sys.argv[1]).glob("*.deb"))
    if not packages:
        sys.exit(f"packages.py: {sys.argv[1]} has no packages; ./dev deb makes them")
    wrong = lint(packages)
    system = BareSystem(pathlib.Path(sys.argv[2]).resolve(), "bookworm")
    system.run("dpkg --purge claray-import claray-mpi claray libclaray-dev libclaray0 || true")  # of an earlier run
    system.put("packages", packages)
    for command in installing():
        system.run(command)
    system.run("apt-get update")
    wrong += check_program(system) + check_development(system)
    for package in packages:
        print(f"{package.name}: {package.stat().st_size / 1e6:.1f} MB")
    for each in wrong:
        print("WRONG:", each)
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
