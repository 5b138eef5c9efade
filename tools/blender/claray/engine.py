# SPDX-License-Identifier: GPL-3.0-or-later
"""The render engine: final renders and the viewport."""

import time

import bpy
import claray
import numpy as np

from . import report as reports
from .camera import camera_of, frame_of
from .geometry import AXES
from .scene import note_seen_lamps, scene_of
from .view import View

SECONDS_BETWEEN_PICTURES = 1.0


def options_of(settings, samples):
    """Options of claray.Renderer."""
    return {"spp": samples, "max_depth": settings.max_depth, "seed": settings.seed, "error": settings.error}


def device_of(settings):
    return None if settings.device == "AUTOMATIC" else settings.device.lower()


def region_of(render, width, height):
    """The part of a picture that is asked for: left, bottom, width, height in pixels."""
    if not render.use_border:
        return 0, 0, width, height
    left, right = (int(np.float32(share) * width) for share in (render.border_min_x, render.border_max_x))
    low, top = (int(np.float32(share) * height) for share in (render.border_min_y, render.border_max_y))
    return left, low, right - left, top - low


class ClarayEngine(bpy.types.RenderEngine):
    bl_idname = "CLARAY"
    bl_label = "claray"
    bl_use_preview = False
    bl_use_eevee_viewport = True  # the material preview
    bl_use_shading_nodes_custom = False  # the nodes are those of Cycles
    bl_use_exclude_layers = True

    _view = None

    def update_render_passes(self, scene, layer):
        self.register_pass(scene, layer, "Combined", 4, "RGBA", "COLOR")
        if layer.use_pass_z:
            self.register_pass(scene, layer, "Depth", 1, "Z", "VALUE")
        if layer.use_pass_normal:
            self.register_pass(scene, layer, "Normal", 3, "XYZ", "VECTOR")
        if scene.claray.use_pass_albedo:
            self.register_pass(scene, layer, "Albedo", 3, "RGB", "COLOR")

    def render(self, depsgraph):
        try:
            self._render(depsgraph)
        except claray.Error as error:
            self.error_set(str(error))  # which raises it for who called the operator
        except Exception as error:
            self.error_set(f"claray's add-on: {type(error).__name__}: {error}")
            raise

    def _render(self, depsgraph):
        scene, settings = depsgraph.scene, depsgraph.scene.claray
        left, low, *size = region_of(scene.render, self.resolution_x, self.resolution_y)
        pixel = scene.render.pixel_aspect_x / scene.render.pixel_aspect_y
        frame = frame_of(scene.camera.data, self.resolution_x, self.resolution_y, pixel)
        region = left + frame.left, low + frame.low, *size
        self.update_stats("", "Reading the scene")
        made, report, seen = scene_of(depsgraph)
        made.camera = camera_of(scene.camera.evaluated_get(depsgraph), self.resolution_x, self.resolution_y, pixel, frame.grown,
                                lambda text: report.note(f"camera '{scene.camera.name}'", text))
        note_seen_lamps(seen, made.camera, frame.width / frame.height, report)
        reports.keep(scene, report.lines)
        if report.lines:
            self.report({"WARNING"}, f"claray leaves out or changes {len(report.lines)} things; its panel lists them")
        self.update_stats("", "Loading kernels")
        renderer = claray.Renderer(made, device=device_of(settings), width=frame.width, height=frame.height, report_seconds=0.2,
                                   **options_of(settings, settings.samples))
        result = self.begin_result(0, 0, region[2], region[3])
        try:
            self._sample(renderer, result, region, settings)
            self._fill(result, "Combined", region, with_alpha(renderer.image(denoise=settings.use_denoising)))
            self._fill_passes(renderer, made.camera, result, region)
        finally:
            self.end_result(result, cancel=False)

    def _sample(self, renderer, result, region, settings):
        shown = time.monotonic()

        def progress(reached):
            nonlocal shown
            self.update_progress(min(reached["spp"] / max(reached["spp_target"], 1), 1.0))
            error = f", error {100 * reached['error']:.1f} %" if settings.error > 0 and reached["error"] > 0 else ""
            self.update_stats("", f"Sample {reached['spp']} of {reached['spp_target']}{error}")
            if not bpy.app.background and reached["spp"] > 0 and time.monotonic() - shown > SECONDS_BETWEEN_PICTURES:
                self._fill(result, "Combined", region, with_alpha(renderer.image()))
                self.update_result(result)
                shown = time.monotonic()
            return not self.test_break()

        renderer.render(progress)

    def _fill(self, result, name, region, pixels):
        """pixels: (H, W, C) of the whole picture, rows from the top; Blender's are from the bottom."""
        left, low, width, height = region
        found = result.layers[0].passes.get(name)
        if found is not None:
            part = pixels[::-1][low:low + height, left:left + width]
            found.rect.foreach_set(np.asarray(part, np.float32).ravel())

    def _fill_passes(self, renderer, camera, result, region):
        names = {one.name for one in result.layers[0].passes}
        if not names & {"Depth", "Normal", "Albedo"}:
            return
        layers = renderer.aovs()
        self._fill(result, "Depth", region, depth_along_view(layers["depth"], camera)[..., None])
        self._fill(result, "Normal", region, layers["normal"] @ AXES[:3, :3])
        self._fill(result, "Albedo", region, layers["albedo"])

    def view_update(self, context, depsgraph):
        if self._view is None:
            self._view = View()
        self._view.update(depsgraph)

    def view_draw(self, context, depsgraph):
        from .draw import draw  # which needs a window
        if self._view is None:
            self.view_update(context, depsgraph)
        region, view = context.region, context.region_data
        pixels = self._view.step(depsgraph.scene.claray, region.width, region.height, view)
        draw(self, depsgraph.scene, pixels, region.width, region.height)
        self.update_stats("", self._view.status)
        if self._view.goes_on:
            self.tag_redraw()


def with_alpha(image):
    image = np.asarray(image)
    return np.concatenate([image, np.ones_like(image[..., :1])], -1)


def depth_along_view(distance, camera):
    """Depth as Blender has it: along the camera's axis, and 1e10 where nothing is."""
    height, width = distance.shape
    depth = np.where(np.isfinite(distance), distance, 1e10)
    if camera.projection != "perspective":
        return depth
    half = np.tan(np.radians(camera.vertical_fov) / 2)
    y = (1 - (np.arange(height) + 0.5) * 2 / height)[:, None] * half
    x = ((np.arange(width) + 0.5) * 2 / width - 1) * half * width / height
    return np.where(np.isfinite(distance), depth / np.sqrt(1 + x * x + y * y), 1e10)
