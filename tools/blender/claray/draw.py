# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws a picture into a 3D view."""

import gpu
import numpy as np
from gpu_extras.presets import draw_texture_2d


def draw(engine, scene, pixels, width, height):
    """pixels: (H, W, 4) float32, linear, rows from the bottom. Blender's colour management converts them."""
    buffer = gpu.types.Buffer("FLOAT", pixels.size, np.ascontiguousarray(pixels, np.float32).ravel())
    texture = gpu.types.GPUTexture((width, height), format="RGBA16F", data=buffer)
    gpu.state.blend_set("ALPHA_PREMULT")
    engine.bind_display_space_shader(scene)
    draw_texture_2d(texture, (0, 0), width, height)
    engine.unbind_display_space_shader()
    gpu.state.blend_set("NONE")
