"""The extension module as a library."""

import subprocess

import claray


def test_shows_no_symbols_of_claray():
    """Else the functions of another library that contains claray could replace them."""
    shown = subprocess.run(["nm", "-D", "--defined-only", "-C", claray._native.__file__], capture_output=True, text=True, check=True)
    names = [line.split(maxsplit=2)[2] for line in shown.stdout.splitlines()]
    assert "PyInit__native" in names and len(names) < 100
    assert not [name for name in names if "claray::" in name or name.startswith("cl::")]
