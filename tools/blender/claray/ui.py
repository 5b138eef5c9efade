# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings and panels."""

import bpy
import claray

from . import report as reports
from .scene import scene_of

# Panels of other engines whose properties claray reads.
SHARED_PANELS = ("EEVEE_MATERIAL_PT_context_material", "EEVEE_MATERIAL_PT_surface", "EEVEE_WORLD_PT_surface", "DATA_PT_EEVEE_light",
                 "DATA_PT_EEVEE_light_shape", "DATA_PT_EEVEE_light_color")


def _devices(settings, context):
    if not _devices.items:
        _devices.items = [("AUTOMATIC", "Automatic", "claray chooses")]
        kinds = {device["type"] for device in claray.devices()}
        _devices.items += [(kind.upper(), kind.upper(), f"The first {kind.upper()} of OpenCL") for kind in ("cpu", "gpu") if kind in kinds]
    return _devices.items


_devices.items = []  # which Python must keep, as Blender does not


class ClaraySettings(bpy.types.PropertyGroup):
    samples: bpy.props.IntProperty(name="Samples", default=128, min=1, max=2**20, description="Samples per pixel of a final render")
    viewport_samples: bpy.props.IntProperty(name="Viewport", default=64, min=1, max=2**20, description="Samples per pixel of a viewport")
    error: bpy.props.FloatProperty(name="Error", default=0.0, min=0.0, max=1.0, precision=3,
                                   description="Stop at this error (RMSE over the mean); 0: at the samples only")
    max_depth: bpy.props.IntProperty(name="Bounces", default=12, min=1, max=1024, description="Surfaces that scatter a path")
    seed: bpy.props.IntProperty(name="Seed", default=0, min=0, description="Of the random numbers")
    device: bpy.props.EnumProperty(name="Device", items=_devices, description="Where claray renders")
    use_denoising: bpy.props.BoolProperty(name="Denoise", default=False, description="Denoise the final render")
    use_pass_albedo: bpy.props.BoolProperty(name="Albedo", default=False, description="Deliver a pass of the surfaces' colours")


class _Panel:
    bl_space_type, bl_region_type, bl_context = "PROPERTIES", "WINDOW", "render"

    @classmethod
    def poll(cls, context):
        return context.engine == "CLARAY"


class CLARAY_PT_sampling(_Panel, bpy.types.Panel):
    bl_label = "Sampling"

    def draw(self, context):
        layout, settings = self.layout, context.scene.claray
        layout.use_property_split = True
        for name in ("device", "samples", "viewport_samples", "error", "max_depth", "seed", "use_denoising"):
            layout.prop(settings, name)


class CLARAY_PT_not_supported(_Panel, bpy.types.Panel):
    bl_label = "Not Supported in This Scene"

    def draw(self, context):
        layout, lines = self.layout, reports.kept(context.scene)
        layout.operator(CLARAY_OT_check.bl_idname)
        if lines is None:
            layout.label(text="Not read yet: render, or press the button")
        elif not lines:
            layout.label(text="Everything is supported", icon="CHECKMARK")
        for line in lines or ():
            layout.label(text=line, icon="ERROR")


class CLARAY_PT_passes(_Panel, bpy.types.Panel):
    bl_label = "Passes"
    bl_context = "view_layer"

    def draw(self, context):
        layout, layer = self.layout, context.view_layer
        layout.use_property_split = True
        layout.prop(layer, "use_pass_z", text="Depth")
        layout.prop(layer, "use_pass_normal", text="Normal")
        layout.prop(context.scene.claray, "use_pass_albedo")


class CLARAY_OT_check(bpy.types.Operator):
    bl_idname = "claray.check"
    bl_label = "Check the Scene"
    bl_description = "List what claray does not support in this scene"

    def execute(self, context):
        lines = scene_of(context.evaluated_depsgraph_get())[1].lines
        reports.keep(context.scene, lines)
        self.report({"INFO"}, f"{len(lines)} things are not supported" if lines else "Everything is supported")
        return {"FINISHED"}


CLASSES = (ClaraySettings, CLARAY_OT_check, CLARAY_PT_sampling, CLARAY_PT_not_supported, CLARAY_PT_passes)


def _panels():
    """Blender's panels that every engine may show, and those of SHARED_PANELS."""
    left_out = {"VIEWLAYER_PT_filter", "VIEWLAYER_PT_layer_passes", "RENDER_PT_freestyle", "RENDER_PT_simplify"}
    for name in dir(bpy.types):
        panel = getattr(bpy.types, name)
        engines = getattr(panel, "COMPAT_ENGINES", None)
        if isinstance(engines, set) and name not in left_out and ("BLENDER_RENDER" in engines or name in SHARED_PANELS):
            yield panel


def register():
    for one in CLASSES:
        bpy.utils.register_class(one)
    bpy.types.Scene.claray = bpy.props.PointerProperty(type=ClaraySettings)
    for panel in _panels():
        panel.COMPAT_ENGINES.add("CLARAY")


def unregister():
    for panel in _panels():
        panel.COMPAT_ENGINES.discard("CLARAY")
    del bpy.types.Scene.claray
    for one in reversed(CLASSES):
        bpy.utils.unregister_class(one)
    reports.forget()
