# SPDX-License-Identifier: GPL-3.0-or-later
"""What of a scene cannot be shown, as lines for the panel."""

_of_scenes = {}


class Report:
    """Lines, each once, in the order in which they were noted."""

    def __init__(self):
        self._lines = {}

    def note(self, where, what):
        """where: "material 'wood'". what: what is left out, and what takes its place."""
        self._lines[f"{where}: {what}"] = None

    @property
    def lines(self):
        return list(self._lines)


def keep(scene, lines):
    """Keeps the lines of a scene's last synchronisation. scene: original or evaluated."""
    _of_scenes[scene.session_uid] = list(lines)


def kept(scene):
    """The lines, or None if the scene was not read yet."""
    return _of_scenes.get(scene.session_uid)


def forget():
    _of_scenes.clear()
