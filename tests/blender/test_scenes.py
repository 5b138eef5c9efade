"""Cameras, passes, instances, the engine and the viewport."""

import math
import sys
import types

import bpy
import claray
import mathutils
import numpy as np
import pytest
import support


def shining_boxes(scene):
    """Boxes of several colours, so that a place in the picture tells a place in space."""
    support.add_box(scene, (-1, -0.6, -0.5), (-0.3, 0.6, 0.5), support.emission((1, 0, 0), name="red"), "left")
    support.add_box(scene, (0.2, -0.2, -0.5), (0.8, 0.9, 0.2), support.emission((0, 1, 0), name="green"), "right")
    support.add_box(scene, (-0.2, -1.1, -0.2), (0.4, -0.7, 0.9), support.emission((0, 0, 1), name="blue"), "below")


def same_places(scene, share=0.04, samples=64):
    """Pictures by both engines, whose difference, of borders and of noise, is at most this share of their mean."""
    ours, cycles = support.both(scene, samples, samples)
    assert cycles.mean() > 0.02
    assert np.abs(ours - cycles).mean() < share * cycles.mean()
    return ours, cycles


CAMERAS = {
    "automatic, wide": (80, 40, dict(sensor_fit="AUTO", lens=35)),
    "automatic, high": (40, 80, dict(sensor_fit="AUTO", lens=60)),
    "horizontal": (40, 80, dict(sensor_fit="HORIZONTAL", lens=35)),
    "vertical": (80, 40, dict(sensor_fit="VERTICAL", lens=35, sensor_height=30)),
    "shifted": (80, 40, dict(lens=35, shift_x=0.2, shift_y=-0.1)),
    "shifted, vertical": (80, 40, dict(lens=35, sensor_fit="VERTICAL", shift_x=-0.1, shift_y=0.2)),
    "parallel, shifted": (40, 80, dict(type="ORTHO", ortho_scale=4, shift_x=-0.1, shift_y=0.1)),
    "parallel, wide": (80, 40, dict(type="ORTHO", ortho_scale=3)),
    "parallel, high": (40, 80, dict(type="ORTHO", ortho_scale=4, sensor_fit="HORIZONTAL")),
}


@pytest.mark.parametrize("name", CAMERAS)
def test_cameras_see_what_cycles_sees(name):
    width, height, values = CAMERAS[name]
    scene = support.empty_scene(width, height)
    for key, value in values.items():
        setattr(scene.camera.data, key, value)
    support.aim(scene.camera, (1, -3, 3), (0, 0, 0))
    scene.camera.scale = (2, 2, 2)  # which counts for nothing
    shining_boxes(scene)
    same_places(scene)


def test_panorama():
    scene = support.empty_scene(96, 48)
    camera = scene.camera
    support.aim(camera, (0, 0, 1.5), (1, 1, 0.5))
    camera.data.type = "PANO"
    if not hasattr(camera.data, "panorama_type"):
        pytest.skip("in this Blender panoramas are settings of Cycles")
    camera.data.panorama_type = "EQUIRECTANGULAR"
    shining_boxes(scene)
    same_places(scene)


def test_depth_of_field():
    scene = support.empty_scene(48, 48)
    scene.camera.data.dof.use_dof, scene.camera.data.dof.aperture_fstop = True, 0.05
    scene.camera.data.dof.focus_distance = 3
    support.add_plane(scene, support.emission((1, 1, 1)), 1)
    ours, cycles = same_places(scene, 0.1, 128)
    row = cycles[24, :, 0]
    assert ((row > 0.05) & (row < 0.95)).sum() > 8  # which is out of focus
    np.testing.assert_allclose(ours[24, :, 0], row, atol=0.2)


def test_passes():
    scene = support.empty_scene(48, 32)
    support.aim(scene.camera, (1, -3, 3), (0, 0, 0))
    support.add_box(scene, (-1, -1, -1), (1, 1, 1), support.diffuse((0.7, 0.3, 0.2)))
    support.set_world(scene, (1, 1, 1))
    layer = scene.view_layers[0]
    layer.use_pass_z = layer.use_pass_normal = scene.claray.use_pass_albedo = True
    engine = sys.modules["claray_addon"].engine
    kept = {}
    fill = engine.ClarayEngine._fill

    def keep(self, result, name, region, pixels):
        fill(self, result, name, region, pixels)
        found = result.layers[0].passes[name]
        values = np.empty((region[3], region[2], found.channels), np.float32)
        found.rect.foreach_get(values.ravel())
        flat = np.empty(values.size, np.float32)
        found.rect.foreach_get(flat)
        kept[name] = flat.reshape(values.shape)[::-1]
    engine.ClarayEngine._fill = keep
    try:
        support.picture(scene, "CLARAY", 1)
    finally:
        engine.ClarayEngine._fill = fill
    # The ray through the middle of a pixel, by Blender's own casting of rays.
    depsgraph = bpy.context.evaluated_depsgraph_get()
    matrix = scene.camera.matrix_world
    frame = [matrix @ corner for corner in scene.camera.data.view_frame(scene=scene)]
    origin = matrix.translation
    for y, x in ((16, 24), (10, 20), (20, 30), (2, 2)):
        right, up = (x + 0.5) / 48, 1 - (y + 0.5) / 32
        top_right, bottom_right, bottom_left, top_left = frame
        place = bottom_left + (bottom_right - bottom_left) * right + (top_left - bottom_left) * up
        hit, point, normal, *_ = scene.ray_cast(depsgraph, origin, (place - origin).normalized())
        if not hit:
            assert kept["Depth"][y, x, 0] == np.float32(1e10)
            continue
        depth = -(matrix.inverted() @ point).z
        assert kept["Depth"][y, x, 0] == pytest.approx(depth, rel=1e-4)
        np.testing.assert_allclose(kept["Normal"][y, x], normal, atol=1e-4)
        np.testing.assert_allclose(kept["Albedo"][y, x], (0.7, 0.3, 0.2), atol=1e-3)


def read(most_copied=0):
    return sys.modules["claray_addon"].ui.scene_of(bpy.context.evaluated_depsgraph_get(), most_copied)[0]


def camera_of(scene):
    width, height = scene.render.resolution_x, scene.render.resolution_y
    evaluated = scene.camera.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return sys.modules["claray_addon"].engine.camera_of(evaluated, width, height, 1.0, 1.0, pytest.fail)


def meshes_and_instances(most_copied=0):
    made = read(most_copied)
    return len(made.meshes), len(made.instances["meshes"])


def test_a_mesh_for_each_data_block():
    scene = support.empty_scene()
    support.instances(scene, 1000)
    assert meshes_and_instances() == (2, 1001)


@pytest.mark.parametrize("triangles, subdivisions", [(320, 3), (20, 1)])
def test_small_meshes_are_copied(triangles, subdivisions):
    """Up to a number of triangles, where a mesh counts as 64 at least; the picture is that of instances."""
    scene = support.empty_scene(64, 48)
    support.instances(scene, 100, subdivisions)
    bpy.data.objects["ball42"].scale.x *= -1
    most = 99 * max(triangles, 64)
    assert meshes_and_instances(most - 1) == (2, 101)
    assert meshes_and_instances(most) == (101, 101)
    made = [read(most_copied) for most_copied in (0, most)]
    camera = camera_of(scene)
    images = []
    for one in made:
        one.camera = camera
        images.append(np.asarray(claray.render(one, width=64, height=48, spp=16)))
    assert np.abs(images[0] - images[1]).mean() < 0.005 * images[0].mean()  # borders and shadows, by the rounding of vertices


def test_instances_of_collections_and_particles():
    scene = support.empty_scene()
    collection = bpy.data.collections.new("part")
    box = support.add_box(scene, (0, 0, 0), (0.2, 0.2, 0.2), support.diffuse((0.5, 0.5, 0.5)))
    scene.collection.objects.unlink(box)
    collection.objects.link(box)
    for x in range(5):
        empty = support.link(scene, f"empty{x}", None)
        empty.instance_type, empty.instance_collection, empty.location = "COLLECTION", collection, (x * 0.4 - 1, 0, 0)
    assert meshes_and_instances() == (1, 5)
    support.set_world(scene, (1, 1, 1))
    same_places(scene)


def test_modifiers_curves_and_texts():
    scene = support.empty_scene()
    cube = support.add_box(scene, (-1, -1, -0.2), (1, 1, 0.2), support.emission((1, 0, 0)))
    cube.modifiers.new("rounded", "SUBSURF").render_levels = 3
    array = cube.modifiers.new("row", "ARRAY")
    array.count = 2
    text = bpy.data.curves.new("text", "FONT")
    text.body, text.extrude = "ab", 0.05
    support.link(scene, "text", text).location = (-0.8, -0.9, 0.5)
    bpy.ops.curve.primitive_bezier_circle_add(radius=0.5, location=(0, 0.9, 0.5))
    bpy.context.object.data.bevel_depth = 0.1
    support.set_world(scene, (0.2, 0.4, 0.2))
    same_places(scene)


def test_smooth_and_flat_faces():
    scene = support.empty_scene(48, 48)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=12, ring_count=8)
    ball = bpy.context.object
    ball.data.materials.append(support.diffuse((0.8, 0.8, 0.8)))
    ball.data.polygons.foreach_set("use_smooth", [polygon.center.x > 0 for polygon in ball.data.polygons])
    support.add_light(scene, "SUN", (0, 0, 3), (2, 1, 0), energy=3, angle=0.01)
    support.set_world(scene, (0.1, 0.1, 0.1))
    ours, cycles = same_places(scene, 0.02, 64)
    np.testing.assert_allclose(ours.mean((0, 1)), cycles.mean((0, 1)), rtol=0.02)


def test_default_cube_and_interior_have_the_means_of_cycles():
    scene = support.default_scene()
    ours, cycles = support.both(scene, 64)
    np.testing.assert_allclose(ours.mean((0, 1)), cycles.mean((0, 1)), rtol=0.02)
    assert support.lines(scene) == []
    scene = support.empty_scene(48, 32)
    support.interior(scene)
    ours, cycles = support.both(scene, 256, 256)
    np.testing.assert_allclose(ours.mean((0, 1)), cycles.mean((0, 1)), rtol=0.02)


def test_animation_follows_the_frame():
    scene = support.empty_scene(32, 32)
    plane = support.add_plane(scene, support.emission((1, 1, 1)), 1)
    for frame, x in ((1, -1), (3, 1)):
        plane.location.x = x
        plane.keyframe_insert("location", frame=frame)
    columns = [(support.picture(scene, "CLARAY", 4, frame)[..., 0].sum(0) * np.arange(32)).sum() for frame in (1, 2, 3)]
    assert columns[0] < columns[1] < columns[2]


@pytest.mark.parametrize("crop", [False, True])
def test_a_region_is_that_part_of_the_picture(crop):
    scene = support.empty_scene(40, 30)
    shining_boxes(scene)
    whole = support.picture(scene, "CLARAY", 4)
    render = scene.render
    render.use_border, render.use_crop_to_border = True, crop
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.25, 0.75, 0.2, 0.6
    part = support.picture(scene, "CLARAY", 4)
    inside = part if crop else part[12:24, 10:30]
    np.testing.assert_array_equal(inside[..., :3], whole[12:24, 10:30, :3])
    if not crop:
        assert part[:12].max() == 0
    assert whole[12:24, 10:30].max() == 1


@pytest.mark.parametrize("calls", [1, 3])
def test_a_cancelled_render_ends_and_keeps_its_samples(calls):
    """Blender's test_break is true after Escape. A module of Blender has no window, and its methods cannot be replaced: an object takes its place."""
    scene = support.empty_scene(64, 48)
    support.interior(scene)
    made, asked, told = read(), [], []
    made.camera = camera_of(scene)
    renderer = claray.Renderer(made, width=64, height=48, spp=2**18, report_seconds=0.02)

    def test_break():
        asked.append(0)
        assert len(asked) <= calls, "goes on"
        return len(asked) == calls
    blender = types.SimpleNamespace(update_progress=lambda share: None, update_stats=lambda where, text: told.append(text),
                                    test_break=test_break)
    sys.modules["claray_addon"].engine.ClarayEngine._sample(blender, renderer, None, None, scene.claray)
    assert len(asked) == calls
    assert 0 < int(told[-1].removeprefix("Sample ").split(" of ")[0]) < 2**17
    whole = support.picture(scene, "CLARAY", 64)[..., :3]
    np.testing.assert_allclose(np.asarray(renderer.image()).mean((0, 1)), whole.mean((0, 1)), rtol=0.1)


def test_errors_are_one_line():
    scene = support.empty_scene(16, 16)
    scene.camera = None
    with pytest.raises(RuntimeError, match="camera"):
        support.picture(scene, "CLARAY", 1)


def test_scene_without_anything():
    scene = support.empty_scene(16, 16)
    support.set_world(scene, (0.25, 0.5, 1))
    np.testing.assert_allclose(support.picture(scene, "CLARAY", 1)[8, 8, :3], (0.25, 0.5, 1), rtol=1e-5)


def test_the_panel_lists_what_is_not_supported():
    scene = support.empty_scene(16, 16)
    scene.render.use_motion_blur = scene.render.film_transparent = True
    plane = support.add_plane(scene, support.diffuse((1, 1, 1)))
    plane.is_holdout, plane.visible_shadow = True, False
    support.link(scene, "smoke", bpy.data.volumes.new("smoke"))
    lamp = support.add_light(scene, "SPOT", (0, 0, 5), energy=10, shadow_soft_size=0.2)
    lamp.data.specular_factor = 0
    scene.render.pixel_aspect_x = 2
    support.picture(scene, "CLARAY", 1)
    told = "\n".join(support.lines(scene))
    for part in ("scene: motion blur", "background is not transparent", "'plane': is a holdout", "'plane': is hidden from some rays",
                 "'smoke': volumes are left out", "'lamp': a spot has no radius", "'lamp': factors for diffuse", "'camera': pixels that are not square"):
        assert part in told
    assert bpy.ops.claray.check() == {"FINISHED"}
    drawn = []
    layout = types.SimpleNamespace(operator=lambda name: drawn.append(name), label=lambda text, icon="": drawn.append(text))
    panel = sys.modules["claray_addon"].ui.CLARAY_PT_not_supported
    panel.draw(types.SimpleNamespace(layout=layout), types.SimpleNamespace(scene=scene))
    assert "object 'smoke': volumes are left out" in drawn


def test_panels_of_blender_are_shown():
    support.load_addon()
    for name in ("RENDER_PT_color_management", "CAMERA_PT_lens", "CAMERA_PT_dof", "MATERIAL_PT_viewport", *(sys.modules["claray_addon"].ui.SHARED_PANELS[:3])):
        panel = getattr(bpy.types, name, None)
        assert panel is None or not hasattr(panel, "COMPAT_ENGINES") or "CLARAY" in panel.COMPAT_ENGINES, name


def test_unregister_leaves_nothing():
    addon = support.load_addon()
    addon.unregister()
    try:
        assert not hasattr(bpy.types.Scene, "claray") and not hasattr(bpy.types, "CLARAY_PT_sampling")
    finally:
        addon.register()


def view_of(scene, width, height):
    """The matrices of a 3D view that looks through the camera."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return types.SimpleNamespace(view_matrix=scene.camera.matrix_world.inverted(),
                                 window_matrix=scene.camera.calc_matrix_camera(depsgraph, x=width, y=height))


@pytest.mark.parametrize("kind, shift", [("PERSP", 0), ("ORTHO", 0), ("PERSP", 0.25), ("ORTHO", -0.25)])
def test_viewport_shows_the_render_and_gets_better(kind, shift):
    scene = support.empty_scene(40, 30)
    support.interior(scene)
    scene.camera.data.type, scene.camera.data.shift_x = kind, shift
    final = support.picture(scene, "CLARAY", 32)[..., :3]
    scene.claray.viewport_samples = 32
    from claray_addon.view import View
    view, matrices = View(), view_of(scene, 40, 30)
    view.update(bpy.context.evaluated_depsgraph_get())
    steps = 0
    while steps == 0 or view.goes_on:
        pixels = view.step(scene.claray, 40, 30, matrices)
        steps += 1
        assert pixels.shape == (30, 40, 4) and steps < 200
    assert view.status == "Sample 32 of 32"
    np.testing.assert_allclose(pixels[::-1, :, :3], final, rtol=0.01, atol=1e-3)  # the same samples
    moved = types.SimpleNamespace(view_matrix=matrices.view_matrix @ mathutils.Matrix.Translation((0.5, 0, 0)), window_matrix=matrices.window_matrix)
    view.step(scene.claray, 40, 30, moved)  # begins anew
    assert np.abs(view.step(scene.claray, 40, 30, moved) - pixels).mean() > 0.01
    assert view.step(scene.claray, 20, 16, moved).shape == (16, 20, 4)


def test_angle_of_the_view():
    support.load_addon()
    scene = support.empty_scene(40, 30)
    from claray_addon.camera import camera_of_view
    camera, frame = camera_of_view(view_of(scene, 40, 30), 40, 30)
    assert (frame.width, frame.height, frame.left, frame.low) == (40, 30, 0, 0)
    assert camera.vertical_fov == pytest.approx(math.degrees(scene.camera.data.angle_y if scene.camera.data.sensor_fit == "VERTICAL" else
                                                            2 * math.atan(18 * 30 / 40 / 50)), rel=1e-4)
    np.testing.assert_allclose(camera.position, (0, 4, 0), atol=1e-6)
