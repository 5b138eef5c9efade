# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture of a viewport, which gets better while nothing changes. Needs no window."""

import numpy as np

import claray

from . import report as reports
from .camera import camera_of_view
from .scene import scene_of

SECONDS_OF_STEP = 0.05


class View:
    def __init__(self):
        self._scene, self._renderer, self._state = None, None, None
        self.status, self.goes_on = "", False

    def update(self, depsgraph):
        """Reads the scene again."""
        self._scene, report, _ = scene_of(depsgraph, 0)  # without copies, whose tree takes longer to build than a step
        reports.keep(depsgraph.scene, report.lines)
        self._renderer = None

    def step(self, settings, width, height, view):
        """Adds samples for about 50 ms, and returns the picture: (H, W, 4) float32, linear, rows from the bottom. A new position of the view,
        size or scene begins anew. view: as of camera_of_view."""
        (camera, frame), options = camera_of_view(view, width, height), self._options(settings)
        state = (frame.width, frame.height, repr(camera), tuple(options.items()))
        if self._renderer is None or state != self._state:
            self._scene.camera = camera
            self._begin(options, state)
            self._state = state
        reached = self._renderer.render(seconds=SECONDS_OF_STEP)
        self.goes_on = reached["spp"] < options["spp"]
        self.status = f"Sample {reached['spp']} of {options['spp']}"
        image = frame.cut(np.asarray(self._renderer.image())[::-1], width, height)
        return np.concatenate([image, np.ones_like(image[..., :1])], -1)

    @staticmethod
    def _options(settings):
        from .engine import device_of
        return {"spp": settings.viewport_samples, "max_depth": settings.max_depth, "seed": settings.seed, "device": device_of(settings)}

    def _begin(self, options, state):
        same = self._renderer is not None and self._state is not None and self._state[3] == state[3]
        if same and self._state[:2] == state[:2]:
            self._renderer.update(self._scene, camera=True)
        else:
            self._renderer = claray.Renderer(self._scene, width=state[0], height=state[1], **options)
