"""A bare system of Debian in a folder, where nothing of claray's is: made by mmdebstrap, entered by chroot. Needs root."""

import os
import pathlib
import shutil
import subprocess
import sys

MIRROR = "http://deb.debian.org/debian"
CERTIFICATES = "etc/ssl/certs/ca-certificates.crt"
NOT_TRIED = 77  # the exit code of a test that cannot run here


def cannot_try(why):
    print(f"{pathlib.Path(sys.argv[0]).name}: {why}; nothing is tried", file=sys.stderr)
    sys.exit(NOT_TRIED)


def require_tools():
    if not shutil.which("mmdebstrap"):
        cannot_try("mmdebstrap is missing: apt-get install mmdebstrap")
    if subprocess.run(["unshare", "--mount", "true"], stderr=subprocess.DEVNULL).returncode:
        cannot_try("only root can mount what a bare system needs")


class BareSystem:
    def __init__(self, folder, release):
        """folder: of systems, each of which is kept. release: of Debian, such as bookworm."""
        self.folder = folder / release
        if not self.folder.exists():
            self._make(release)
        shutil.copy(pathlib.Path("/", CERTIFICATES), self.folder / CERTIFICATES)  # also of a proxy
        shutil.copy("/etc/resolv.conf", self.folder / "etc/resolv.conf")
        (self.folder / "etc/apt/apt.conf.d/80-retries").write_text('Acquire::Retries "5";\n')

    def _make(self, release):
        print(f"making {self.folder}", file=sys.stderr)
        self.folder.parent.mkdir(parents=True, exist_ok=True)
        unfinished = self.folder.with_suffix(".unfinished")
        shutil.rmtree(unfinished, ignore_errors=True)
        made = subprocess.run(["mmdebstrap", "--quiet", "--variant=minbase", "--include=python3,python3-venv,ca-certificates", release,
                               unfinished, MIRROR])
        if made.returncode:
            cannot_try(f"cannot make a bare {release}")
        unfinished.rename(self.folder)

    def put(self, name, files):
        """Copies files into a new folder /name."""
        shutil.rmtree(self.folder / name, ignore_errors=True)
        (self.folder / name).mkdir()
        for path in files:
            shutil.copy(path, self.folder / name)

    def run(self, command):
        """What the command prints. Ends this program if it fails."""
        clean = {"HOME": "/root", "PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "PIP_DISABLE_PIP_VERSION_CHECK": "1",
                 "DEBIAN_FRONTEND": "noninteractive"}
        clean |= {name: value for name, value in os.environ.items() if name.lower().endswith("_proxy")}
        mounted = 'mount -t proc proc "$0/proc" && mount --rbind /dev "$0/dev" && mount --rbind /sys "$0/sys"'
        inside = ["unshare", "--mount", "sh", "-c", mounted + ' && exec chroot "$0" sh -c "$1"', self.folder, command]
        done = subprocess.run(inside, env=clean, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        if done.returncode:
            sys.exit(f"{pathlib.Path(sys.argv[0]).name}: {command}: {done.stdout[-2000:]}")
        return done.stdout
