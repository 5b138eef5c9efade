"""What materials, meshes and lights of gltf.py are in Mitsuba 3, whose variant the importing program has set.

glTF's dielectrics are `principled` there: the same interface over another diffuse base, which makes means differ by some per cent.
"""
import mitsuba as mi
import numpy as np

from gltf import vertex_colors


def uvs_of(shape, m):
    """Texture coordinates after the transform of KHR_texture_transform: v downwards."""
    if "transform" not in m:
        return shape[2]
    x, y, turn, sx, sy = m["transform"]
    c, s = np.cos(turn), np.sin(turn)
    return shape[2] * [sx, sy] @ np.array([[c, s], [-s, c]]).T + [x, y]


def bitmap(pixels, raw, nearest=False):
    return dict(type="bitmap", bitmap=mi.Bitmap(np.ascontiguousarray(pixels[..., None] if pixels.ndim == 2 else pixels)), raw=raw,
                filter_type="nearest" if nearest else "bilinear")


def bsdf_of(m):
    if m["kind"] == "mirror":
        return dict(type="conductor", material="none")
    if m["kind"] == "glass":
        return dict(type="dielectric", int_ior=1.5, ext_ior=1.0)
    if m["kind"] == "lamp":
        return dict(type="diffuse", reflectance=dict(type="rgb", value=[0, 0, 0]))
    reflectance = dict(type="rgb", value=list(m["color"]))
    if m.get("vertex_colors"):
        reflectance = dict(type="mesh_attribute", name="vertex_color")
    if "texture" in m:
        linear = np.array(mi.Bitmap(m["texture"]).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False))
        reflectance = bitmap(linear * np.array(m["color"], np.float32), True)
    bsdf = dict(type="diffuse", reflectance=reflectance)
    if m["kind"] == "gltf":
        bsdf = dict(type="principled", base_color=reflectance, metallic=m["metallic"], roughness=m["roughness"], specular=0.5)
    if "normals" in m:
        bsdf = dict(type="normalmap", normalmap=bitmap(m["normals"], True), bsdf=bsdf)
    bsdf = dict(type="twosided", bsdf=bsdf)
    if "mask" in m:
        bsdf = dict(type="mask", opacity=bitmap(m["mask"], True, True), bsdf=bsdf)
    return bsdf


def shape_of(shape, m):
    positions, normals, uvs, triangles = shape
    scale = np.array(m.get("scale", (1, 1, 1)), np.float32)
    uvs = uvs_of(shape, m)  # v downwards, as the rows of a bitmap
    props = mi.Properties()
    props["bsdf"] = mi.load_dict(bsdf_of(m))
    if m["kind"] == "lamp":
        props["emitter"] = mi.load_dict(dict(type="area", radiance=dict(type="rgb", value=list(m["color"]))))
    mesh = mi.Mesh("mesh", len(positions), len(triangles), props, True, True)
    params = mi.traverse(mesh)
    if m.get("vertex_colors"):
        mesh.add_attribute("vertex_color", 3, (vertex_colors(positions) * np.array(m["color"], np.float32)).ravel())
    params["vertex_positions"], params["vertex_normals"] = (positions * scale).ravel(), (normals * scale).ravel()
    params["vertex_texcoords"], params["faces"] = uvs.astype(np.float32).ravel(), triangles.ravel()
    params.update()
    return mesh


def light_of(light):
    color = dict(type="rgb", value=list(light["color"]))
    if light["kind"] == "point":
        return dict(type="point", position=list(light["position"]), intensity=color)
    if light["kind"] == "directional":
        return dict(type="directional", direction=list(light["direction"]), irradiance=color)
    to_world = mi.ScalarTransform4f().look_at(origin=light["position"], target=light.get("target", (0, 0, 0)), up=(0, 1, 0.1))
    return dict(type="spot", to_world=to_world, intensity=color, cutoff_angle=light["angle"], beam_width=light["angle"] - 0.05)
