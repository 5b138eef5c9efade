"""claray.usd: what USD means, by stages that the tests write. Skipped without usd-core."""

import math
import pathlib
import subprocess
import sys
import warnings

import numpy as np
import pytest

import claray

pytest.importorskip("pxr", reason="usd-core is not installed (PyPI)")
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdShade, UsdUtils, Vt  # noqa: E402

import claray.usd  # noqa: E402


@pytest.fixture
def stage(tmp_path):
    """A stage in metres, y upwards, with the path of its file."""
    made = Usd.Stage.CreateNew(str(tmp_path / "scene.usda"))
    UsdGeom.SetStageUpAxis(made, UsdGeom.Tokens.y)
    UsdGeom.SetStageMetersPerUnit(made, 1.0)
    return made


def loaded(stage, **choices):
    stage.GetRootLayer().Save()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        scene = claray.usd.load(stage.GetRootLayer().realPath, **choices)
    return scene, [str(one.message) for one in caught]


def quad(stage, path="/quad", side=2.0, scheme="none"):
    """Two units wide, in the plane z = 0, seen from +z."""
    mesh = UsdGeom.Mesh.Define(stage, path)
    half = side / 2
    mesh.CreatePointsAttr([(-half, -half, 0), (half, -half, 0), (half, half, 0), (-half, half, 0)])
    mesh.CreateFaceVertexCountsAttr([4])
    mesh.CreateFaceVertexIndicesAttr([0, 1, 2, 3])
    mesh.CreateSubdivisionSchemeAttr(scheme)
    return mesh


def preview(stage, path="/look", **values):
    """A material of a UsdPreviewSurface. Returns it and its shader."""
    material = UsdShade.Material.Define(stage, path)
    shader = UsdShade.Shader.Define(stage, path + "/surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    for name, value in values.items():
        kind = Sdf.ValueTypeNames.Color3f if isinstance(value, tuple) else Sdf.ValueTypeNames.Int if isinstance(value, int) else Sdf.ValueTypeNames.Float
        shader.CreateInput(name, kind).Set(value)
    material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    return material, shader


def bind(mesh, material):
    UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(material)


def image_of(stage, shader, name, file, output="rgb", path="/look/image", **inputs):
    texture, reader = UsdShade.Shader.Define(stage, path), UsdShade.Shader.Define(stage, path + "_st")
    texture.CreateIdAttr("UsdUVTexture")
    texture.CreateInput("file", Sdf.ValueTypeNames.Asset).Set(str(file))
    for key, value in inputs.items():
        texture.CreateInput(key, Sdf.ValueTypeNames.Token if isinstance(value, str) else Sdf.ValueTypeNames.Float4).Set(value)
    reader.CreateIdAttr("UsdPrimvarReader_float2")
    reader.CreateInput("varname", Sdf.ValueTypeNames.Token).Set("st")
    texture.CreateInput("st", Sdf.ValueTypeNames.Float2).ConnectToSource(reader.ConnectableAPI(), "result")
    kind = Sdf.ValueTypeNames.Color3f if output == "rgb" else Sdf.ValueTypeNames.Float
    shader.CreateInput(name, kind).ConnectToSource(texture.ConnectableAPI(), output)
    return texture


def with_st(mesh):
    UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("st", Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.vertex).Set([(0, 0), (1, 0), (1, 1), (0, 1)])


def test_axis_and_unit(stage):
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 0.01)
    mesh = quad(stage, side=200)
    UsdGeom.XformCommonAPI(mesh).SetTranslate((0, 0, 300))
    scene, told = loaded(stage)
    np.testing.assert_allclose(scene.bounds, [(-1, 3, -1), (1, 3, 1)], atol=1e-6)
    assert scene.triangle_count == 2 and not [line for line in told if "light" not in line]


def test_faces(stage):
    """Polygons of several sizes, holes, and the left-handed order."""
    mesh = UsdGeom.Mesh.Define(stage, "/mesh")
    mesh.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (5, 5, 0)])
    mesh.CreateFaceVertexCountsAttr([5, 3, 2])
    mesh.CreateFaceVertexIndicesAttr([0, 1, 2, 3, 4, 0, 1, 5, 0, 1])
    mesh.CreateHoleIndicesAttr([1])
    mesh.CreateOrientationAttr(UsdGeom.Tokens.leftHanded)
    mesh.CreateSubdivisionSchemeAttr("none")
    scene, _ = loaded(stage)
    points, faces = scene.meshes[0]["vertices"], scene.meshes[0]["triangles"]
    assert len(faces) == 3 and points.max() == 2
    a, b, c = (points[faces[:, i]] for i in range(3))
    assert (np.cross(b - a, c - a)[:, 2] < 0).all()


def test_values_of_unknown_types_are_refused(stage, tmp_path):
    material, shader = preview(stage)
    image_of(stage, shader, "diffuseColor", save_texels(tmp_path))
    bind(quad(stage), material)
    stage.GetRootLayer().Save()
    damaged = tmp_path / "damaged.usda"
    damaged.write_text((tmp_path / "scene.usda").read_text().replace('token info:id = "UsdPrimvarReader', 'inf info:id = "UsdPrimvarReader'))
    with pytest.raises(claray.InputError, match="damaged.usda' is damaged"):
        claray.usd.load(damaged)


def test_damaged_faces_are_left_out(stage):
    mesh = quad(stage)
    mesh.CreateFaceVertexIndicesAttr([0, 1, 2, 9])
    quad(stage, "/sound")
    scene, told = loaded(stage)
    assert scene.triangle_count == 2 and any("'/quad' has faces of vertices that do not exist" in line for line in told)


@pytest.mark.parametrize("name, count", [("vertex", 4), ("faceVarying", 4), ("uniform", 1), ("constant", 1)])
def test_normals(stage, name, count):
    mesh = quad(stage)
    mesh.CreateNormalsAttr([(0.6, 0, 0.8)] * count)
    mesh.SetNormalsInterpolation(name)
    scene, _ = loaded(stage)
    np.testing.assert_allclose(scene.meshes[0]["normals"], [(0.6, 0, 0.8)] * 4, atol=1e-6)


def test_subdivision_is_off_and_smooth(stage):
    cube = UsdGeom.Mesh.Define(stage, "/cube")
    cube.CreatePointsAttr([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    cube.CreateFaceVertexCountsAttr([4] * 6)
    cube.CreateFaceVertexIndicesAttr([0, 1, 3, 2, 4, 6, 7, 5, 0, 4, 5, 1, 2, 3, 7, 6, 0, 2, 6, 4, 1, 5, 7, 3])
    scene, _ = loaded(stage)
    mesh = scene.meshes[0]
    assert len(mesh["triangles"]) == 12 and np.abs(mesh["vertices"]).min() == 1
    assert (np.sum(mesh["normals"] * mesh["vertices"], 1) > 1.4).all()  # outwards at each corner


@pytest.mark.parametrize("schema, volume", [(UsdGeom.Cube, 8), (UsdGeom.Sphere, 4 / 3 * math.pi), (UsdGeom.Cylinder, 2 * math.pi),
                                            (UsdGeom.Cone, 2 / 3 * math.pi), (UsdGeom.Capsule, math.pi * 0.25 + math.pi / 6)])
def test_solids(stage, schema, volume):
    """Their defaults, closed and outwards."""
    schema.Define(stage, "/solid")
    scene, _ = loaded(stage)
    mesh = scene.meshes[0]
    a, b, c = (mesh["vertices"][mesh["triangles"][:, i]].astype(np.float64) for i in range(3))
    assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6 == pytest.approx(volume, rel=0.03)


def test_instances_share_meshes(stage):
    stage.CreateClassPrim("/_part")
    quad(stage, "/_part/quad")
    for i in range(5):
        place = UsdGeom.Xform.Define(stage, f"/place{i}")
        place.GetPrim().GetReferences().AddInternalReference("/_part")
        place.GetPrim().SetInstanceable(True)
        UsdGeom.XformCommonAPI(place).SetTranslate((3 * i, 0, 0))
    scene, _ = loaded(stage)
    assert len(scene.meshes) == 1 and len(scene.instances["meshes"]) == 5
    np.testing.assert_allclose(sorted(scene.instances["transforms"][:, 0, 3]), [0, 3, 6, 9, 12])


def test_point_instancer(stage):
    instancer = UsdGeom.PointInstancer.Define(stage, "/many")
    UsdGeom.XformCommonAPI(instancer).SetTranslate((0, 10, 0))
    part = quad(stage, "/many/quad")
    UsdGeom.XformCommonAPI(part).SetScale((2, 2, 2))
    UsdGeom.Sphere.Define(stage, "/many/ball")
    instancer.CreatePrototypesRel().SetTargets(["/many/quad", "/many/ball"])
    instancer.CreateProtoIndicesAttr([0, 1, 0, 0])
    instancer.CreatePositionsAttr([(0, 0, 0), (5, 0, 0), (10, 0, 0), (20, 0, 0)])
    instancer.CreateIdsAttr([1, 2, 3, 4])
    instancer.CreateInvisibleIdsAttr([3])
    scene, _ = loaded(stage)
    placed = scene.instances
    assert len(scene.meshes) == 2 and len(placed["meshes"]) == 3
    np.testing.assert_allclose(sorted(placed["transforms"][:, 0, 3]), [0, 5, 20])
    np.testing.assert_allclose(placed["transforms"][:, 1, 3], 10)
    assert sorted(placed["transforms"][:, 0, 0]) == pytest.approx([1, 2, 2])


def test_hidden_prims_and_purposes(stage):
    quad(stage, "/seen")
    quad(stage, "/hidden").MakeInvisible()
    for purpose in ("proxy", "guide", "render"):
        quad(stage, f"/{purpose}").CreatePurposeAttr(purpose)
    stage.OverridePrim("/over")
    scene, _ = loaded(stage)
    assert scene.triangle_count == 4  # of /seen and /render


def test_colours_without_a_material(stage):
    UsdGeom.PrimvarsAPI(quad(stage, "/one")).CreatePrimvar("displayColor", Sdf.ValueTypeNames.Color3fArray, UsdGeom.Tokens.constant).Set([(0.2, 0.4, 0.6)])
    UsdGeom.PrimvarsAPI(quad(stage, "/each")).CreatePrimvar("displayColor", Sdf.ValueTypeNames.Color3fArray, UsdGeom.Tokens.vertex).Set(
        [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)])
    scene, _ = loaded(stage)
    by = {mesh["name"]: mesh for mesh in scene.meshes}
    np.testing.assert_allclose(by["each"]["colors"][:, :3], [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)], atol=1e-6)
    assert sorted(material.albedo for material in scene.materials)[0] == pytest.approx((0.2, 0.4, 0.6))


def test_numbers_of_a_preview_surface(stage):
    material, _ = preview(stage, diffuseColor=(0.2, 0.4, 0.6), metallic=0.25, roughness=0.75, clearcoat=0.5, clearcoatRoughness=0.125, ior=1.25,
                          opacity=0.5, emissiveColor=(4.0, 2.0, 1.0))
    bind(quad(stage), material)
    scene, _ = loaded(stage)
    made = scene.materials[0]
    assert made.albedo == pytest.approx((0.2, 0.4, 0.6)) and made.emission == pytest.approx((4, 2, 1))
    assert (made.metallic, made.roughness, made.clearcoat, made.clearcoat_roughness, made.ior, made.opacity, made.alpha_mode) == (
        0.25, 0.75, 0.5, 0.125, 1.25, 0.5, "blend")
    assert made.name == "look" and not made.cull_back


def test_mask_of_opacity(stage):
    bind(quad(stage), preview(stage, opacityThreshold=0.25)[0])
    scene, _ = loaded(stage)
    assert (scene.materials[0].alpha_mode, scene.materials[0].alpha_cutoff) == ("mask", 0.25)


TEXELS = np.zeros((4, 4, 4), np.uint8)
TEXELS[..., 0], TEXELS[..., 1], TEXELS[..., 2], TEXELS[..., 3] = 40, 80, 120, 200
TEXELS[:2, :2, 0] = 255  # the top left


def save_texels(tmp_path, texels=TEXELS, name="image.png"):
    claray.Texture(texels).save(tmp_path / name)
    return tmp_path / name


def test_images_stand_upright(stage, tmp_path):
    """The top left of an image is at st = (0, 1)."""
    material, shader = preview(stage, diffuseColor=(0.0, 0.0, 0.0))
    image_of(stage, shader, "emissiveColor", save_texels(tmp_path))
    mesh = quad(stage)
    with_st(mesh)
    bind(mesh, material)
    scene, _ = loaded(stage)
    scene.camera = claray.Camera(position=(0, 0, 5), target=(0, 0, 0), orthographic_height=2)
    image = np.asarray(claray.render(scene, width=8, height=8, spp=1))
    assert image[1, 1, 0] > 0.9 and image[1, 6, 0] < 0.1 and image[6, 1, 0] < 0.1
    assert image[6, 6] == pytest.approx(((np.array([40, 80, 120]) / 255 + 0.055) / 1.055) ** 2.4, rel=0.02)


def test_files_of_images_are_kept_as_they_are(stage, tmp_path):
    material, shader = preview(stage)
    image_of(stage, shader, "diffuseColor", save_texels(tmp_path), scale=Gf.Vec4f(0.5, 1, 1, 1))
    mesh = quad(stage)
    with_st(mesh)
    bind(mesh, material)
    scene, _ = loaded(stage)
    np.testing.assert_array_equal(scene.textures[0].pixels[..., :3], TEXELS[..., :3])
    assert scene.materials[0].albedo == pytest.approx((0.5, 1, 1)) and scene.materials[0].alpha_mode == "opaque"


@pytest.mark.parametrize("space, bias", [("raw", 0.0), ("auto", 0.25), ("raw", 0.25)])
def test_colours_are_computed_where_gltf_has_no_word_for_them(stage, tmp_path, space, bias):
    """Linear texels, and a bias."""
    material, shader = preview(stage)
    texels = np.full((2, 2, 3), (40, 80, 120), np.uint8)
    image_of(stage, shader, "diffuseColor", save_texels(tmp_path, texels), sourceColorSpace=space, scale=Gf.Vec4f(0.5, 0.5, 0.5, 1),
             bias=Gf.Vec4f(bias, bias, bias, 0))
    mesh = quad(stage)
    with_st(mesh)
    bind(mesh, material)
    scene, _ = loaded(stage)
    made = scene.textures[0].pixels[0, 0, :3] / 255

    def decoded(values):
        return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)
    expected = (texels[0, 0] / 255 if space == "raw" else decoded(texels[0, 0] / 255)) * 0.5 + bias
    np.testing.assert_allclose(decoded(made) * scene.materials[0].albedo, expected, atol=0.01)


def test_channels_are_packed(stage, tmp_path):
    """Roughness of red and metallic of green become green and blue; opacity of blue becomes alpha."""
    material, shader = preview(stage)
    file = save_texels(tmp_path)
    for i, (name, channel) in enumerate((("roughness", "r"), ("metallic", "g"), ("opacity", "b"))):
        image_of(stage, shader, name, file, channel, f"/look/image{i}", sourceColorSpace="raw")
    mesh = quad(stage)
    with_st(mesh)
    bind(mesh, material)
    scene, _ = loaded(stage)
    made = scene.materials[0]
    packed = scene.textures[made.metallic_roughness_map.texture].pixels
    np.testing.assert_array_equal(packed[..., 1], TEXELS[..., 0])
    np.testing.assert_array_equal(packed[..., 2], TEXELS[..., 1])
    np.testing.assert_array_equal(scene.textures[made.albedo_map.texture].pixels[..., 3], TEXELS[..., 2])
    assert made.alpha_mode == "blend" and made.roughness == made.metallic == 1


def test_normal_maps(stage, tmp_path):
    """By the usual scale and bias as they are; else computed."""
    slopes = np.full((2, 2, 3), (204, 128, 230), np.uint8)
    file = save_texels(tmp_path, slopes, "normal.png")
    for i, (scale, bias, expected) in enumerate((((2, 2, 2, 2), (-1, -1, -1, -1), (204, 128, 230)), ((2, -2, 2, 1), (-1, 1, -1, 0), (204, 127, 230)))):
        material, shader = preview(stage, f"/look{i}")
        image_of(stage, shader, "normal", file, "rgb", f"/look{i}/image", sourceColorSpace="raw", scale=Gf.Vec4f(*scale), bias=Gf.Vec4f(*bias))
        mesh = quad(stage, f"/quad{i}")
        with_st(mesh)
        bind(mesh, material)
    scene, _ = loaded(stage)
    seen = sorted(tuple(scene.textures[one.normal_map.texture].pixels[0, 0, :3]) for one in scene.materials)
    assert seen == [(204, 127, 230), (204, 128, 230)]


def test_materials_of_parts(stage):
    mesh = UsdGeom.Mesh.Define(stage, "/mesh")
    mesh.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)])
    mesh.CreateFaceVertexCountsAttr([3, 3])
    mesh.CreateFaceVertexIndicesAttr([0, 1, 2, 1, 3, 2])
    mesh.CreateSubdivisionSchemeAttr("none")
    bind(mesh, preview(stage, "/first", diffuseColor=(1.0, 0.0, 0.0))[0])
    subset = UsdShade.MaterialBindingAPI(mesh).CreateMaterialBindSubset("part", Vt.IntArray([1]))
    bind(subset, preview(stage, "/second", diffuseColor=(0.0, 1.0, 0.0))[0])
    scene, _ = loaded(stage)
    colors = {scene.materials[int(number)].albedo for one in scene.meshes for number in (one["materials"] if len(one["materials"]) else [0])}
    assert colors == {(1, 0, 0), (0, 1, 0)}


def irradiance(scene, own_sky=False):
    """Of a white floor at the origin: its radiance times pi. own_sky: whether the surroundings are the file's, not those that are added
    where lamps reach little of what is seen."""
    if not own_sky:
        scene.environment, scene.sky = None, (0, 0, 0)
    floor = scene.add_material(albedo=(1, 1, 1))
    scene.add_instance(scene.add_mesh([(-0.2, 0, -0.2), (0.2, 0, -0.2), (0.2, 0, 0.2), (-0.2, 0, 0.2)], [(0, 2, 1), (0, 3, 2)], material=floor))
    for i in range(len(scene.meshes) - 1):  # which the first instance would hide
        if i not in scene.instances["meshes"]:
            scene.add_instance(i)
    scene.camera = claray.Camera(position=(0, 1, 0), target=(0, 0, 0), up=(0, 0, 1), vertical_fov=2)
    image = np.asarray(claray.render(scene, width=16, height=16, spp=256, max_depth=1))
    return image.mean((0, 1)) * math.pi


def above(light, height):
    """Places a light above the origin, which shines downwards, and something to see far below."""
    UsdGeom.XformCommonAPI(quad(light.GetPrim().GetStage(), "/speck")).SetTranslate((0, -50, 0))
    form = UsdGeom.XformCommonAPI(light)
    form.SetTranslate((0, height, 0))
    form.SetRotate((-90, 0, 0))


def test_distant_lights(stage):
    light = UsdLux.DistantLight.Define(stage, "/sun")
    above(light, 0)
    light.CreateAngleAttr(20)
    light.CreateIntensityAttr(10)
    light.CreateExposureAttr(1)
    light.CreateColorAttr((1, 0.5, 0.25))
    scene, told = loaded(stage)
    assert not told and [one.kind for one in scene.lights] == ["sun"]
    expected = 20 * math.pi * math.sin(math.radians(10)) ** 2
    np.testing.assert_allclose(irradiance(scene), expected * np.array([1, 0.5, 0.25]), rtol=0.02)


def test_normalized_distant_light(stage):
    light = UsdLux.DistantLight.Define(stage, "/sun")
    above(light, 0)
    light.CreateIntensityAttr(3)
    light.CreateNormalizeAttr(True)
    np.testing.assert_allclose(irradiance(loaded(stage)[0]), 3, rtol=0.02)


@pytest.mark.parametrize("normalize", [False, True])
def test_lamps_with_a_size(stage, normalize):
    """A rectangle of radiance L and area A, from far above: an irradiance of L A / h^2."""
    light = UsdLux.RectLight.Define(stage, "/lamp")
    above(light, 10)
    light.CreateWidthAttr(0.5)
    light.CreateHeightAttr(0.25)
    light.CreateIntensityAttr(100)
    light.CreateNormalizeAttr(normalize)
    scene, _ = loaded(stage)
    np.testing.assert_allclose(irradiance(scene), 100 * (1 if normalize else 0.125) / 100, rtol=0.02)


@pytest.mark.parametrize("treat, cone, kinds", [(False, None, []), (True, None, ["point"]), (False, 30.0, ["spot"])])
def test_ball_and_point_and_spot(stage, treat, cone, kinds):
    light = UsdLux.SphereLight.Define(stage, "/lamp")
    above(light, 4)
    light.CreateRadiusAttr(0.25)
    light.CreateIntensityAttr(50)
    light.CreateTreatAsPointAttr(treat)
    if cone:
        UsdLux.ShapingAPI.Apply(light.GetPrim()).CreateShapingConeAngleAttr(cone)
    scene, _ = loaded(stage)
    assert [one.kind for one in scene.lights] == kinds
    np.testing.assert_allclose(irradiance(scene), 50 * math.pi / 16 / 16, rtol=0.03)


def test_dome(stage):
    UsdLux.DomeLight.Define(stage, "/dome").CreateColorAttr((0.5, 1, 2))
    UsdGeom.XformCommonAPI(quad(stage, "/speck")).SetTranslate((0, -50, 0))
    scene, told = loaded(stage)
    assert scene.sky[0] == pytest.approx((0.5, 1, 2)) and not told
    np.testing.assert_allclose(irradiance(scene, True), math.pi * np.array([0.5, 1, 2]), rtol=0.02)


@pytest.mark.parametrize("degrees, axis", [(0, "y"), (90, "y"), (90, "x")])
def test_image_of_a_dome(stage, tmp_path, degrees, axis):
    """The middle of the image is towards +z of the dome."""
    texels = np.full((16, 32, 3), 0, np.float32)
    texels[6:10, 14:18] = 3, 2, 1
    texels.view(claray.Image).save(tmp_path / "dome.hdr")
    dome = UsdLux.DomeLight.Define(stage, "/dome")
    dome.CreateTextureFileAttr("dome.hdr")
    UsdGeom.XformCommonAPI(dome).SetRotate((degrees if axis == "x" else 0, degrees if axis == "y" else 0, 0))
    quad(stage, side=0.01)
    scene, _ = loaded(stage)
    angle = math.radians(degrees)
    direction = np.array((math.sin(angle), 0, math.cos(angle)) if axis == "y" else (0, -math.sin(angle), math.cos(angle)))
    scene.camera = claray.Camera(position=direction, target=2 * direction, up=(1, 0, 0) if axis == "x" else (0, 1, 0), vertical_fov=4)
    np.testing.assert_allclose(np.asarray(claray.render(scene, width=4, height=4, spp=4)).mean((0, 1)), (3, 2, 1), rtol=0.02)


def test_cameras(stage):
    quad(stage)
    camera = UsdGeom.Camera.Define(stage, "/eye")
    UsdGeom.XformCommonAPI(camera).SetTranslate((0, 0, 7))
    camera.CreateFocalLengthAttr(50)
    camera.CreateVerticalApertureAttr(24)
    camera.CreateFStopAttr(2.8)
    scene, told = loaded(stage)
    assert scene.camera.vertical_fov == pytest.approx(math.degrees(2 * math.atan(12 / 50)), rel=1e-4)
    assert scene.camera.position == pytest.approx((0, 0, 7)) and "camera 'eye': depth of field is left out" in told
    with pytest.raises(claray.UsageError, match="eye"):
        loaded(stage, camera="nose")


def test_time(stage):
    mesh = quad(stage)
    move = UsdGeom.Xformable(mesh).AddTranslateOp()
    move.Set((0, 0, 0), 10)
    move.Set((12, 0, 0), 34)
    stage.SetStartTimeCode(10)
    stage.SetEndTimeCode(34)
    for time, x in ((None, 0), (0.0, 0), (0.5, 6), (1.0, 12)):
        assert loaded(stage, time=time)[0].bounds[:, 0].mean() == pytest.approx(x, abs=1e-5)


def test_archive(stage, tmp_path):
    material, shader = preview(stage)
    image_of(stage, shader, "diffuseColor", save_texels(tmp_path))
    mesh = quad(stage)
    with_st(mesh)
    bind(mesh, material)
    stage.GetRootLayer().Save()
    packed = tmp_path / "scene.usdz"
    assert UsdUtils.CreateNewUsdzPackage(stage.GetRootLayer().realPath, str(packed))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        scene = claray.usd.load(packed)
    np.testing.assert_array_equal(scene.textures[0].pixels[..., :3], TEXELS[..., :3])


def test_what_is_left_out_is_told(stage):
    bind(quad(stage), UsdShade.Material.Define(stage, "/empty"))
    material, shader = preview(stage, "/look")
    image_of(stage, shader, "diffuseColor", "nowhere.png")
    bind(quad(stage, "/other"), material)
    UsdGeom.NurbsPatch.Define(stage, "/patch")
    _, told = loaded(stage)
    for part in ("material '/empty' has no UsdPreviewSurface", "the image 'nowhere.png' is missing", "'/patch' is of the type NurbsPatch"):
        assert any(part in line for line in told), told


def test_bad_files(tmp_path):
    with pytest.raises(claray.InputError, match="does not exist"):
        claray.usd.load(tmp_path / "none.usda")
    for name, content in (("bad.usda", b"#usda 1.0\ndef Mesh {"), ("bad.usdc", b"PXR-USDC" + b"\1" * 100), ("bad.usdz", b"PK\3\4" + b"\0" * 60)):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(claray.InputError, match=name) as raised:
            claray.usd.load(tmp_path / name)
        assert "\n" not in str(raised.value)
    for content in (b"#usda 1.0\ndef Mesh \"a\xbf\" {}\n", b"#usda 1.0\ndef Mesh \"a\" { int[] faceVertexCounts = [\xbf] }\n"):
        (tmp_path / "letters.usda").write_bytes(content)
        with pytest.raises(claray.InputError, match="letters.usda") as raised:
            claray.usd.load(tmp_path / "letters.usda")
        assert "\n" not in str(raised.value)
    with pytest.raises(claray.UsageError, match="variant"):
        claray.usd.load(tmp_path / "bad.usda", variant="red")


def test_program_s_files(stage, tmp_path):
    UsdLux.DistantLight.Define(stage, "/sun")
    quad(stage)
    stage.GetRootLayer().Save()
    done = subprocess.run([sys.executable, "-m", "claray.usd", stage.GetRootLayer().realPath, tmp_path / "out.glb"], text=True, capture_output=True)
    assert done.returncode == 0 and not done.stderr and (tmp_path / "out.json").exists()
    done = subprocess.run([sys.executable, "-m", "claray.usd", tmp_path / "none.usda", tmp_path / "no.glb"], text=True, capture_output=True)
    assert done.returncode == 1 and "none.usda" in done.stderr.splitlines()[-1] and not (tmp_path / "no.glb").exists()


def test_forged_files_are_read_or_refused():
    script = pathlib.Path(__file__).parents[2] / "fuzz/forged_usd.py"
    result = subprocess.run([sys.executable, script, "40"], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout + result.stderr
    assert result.stdout.count("40 changes:") == 3 and "crashed" not in result.stdout
