# SPDX-License-Identifier: GPL-3.0-or-later
"""claray as a render engine of Blender 4.5 and 5. docs/blender.md of claray's sources describes it."""

import bpy

from . import engine, ui


def register():
    ui.register()
    bpy.utils.register_class(engine.ClarayEngine)


def unregister():
    bpy.utils.unregister_class(engine.ClarayEngine)
    ui.unregister()
