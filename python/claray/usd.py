"""Scenes of USD: .usd, .usda, .usdc and .usdz, by the library usd-core of PyPI (pip install usd-core).

    scene = claray.usd.load("kitchen.usdz")

docs/formats.md says what is read. `python -m claray.usd FILE OUT.glb` writes a file of glTF, and beside it OUT.json with what glTF lacks: the program
`claray` reads USD so.
"""

# pyright: basic, reportAttributeAccessIssue=false
# pxr states no types.
from __future__ import annotations

import json
import math
import os
import sys
import tempfile
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._arrays import number, path_of
from ._glb import Glb
from ._handle import warn
from ._records import set_all
from ._scene import LoadOptions, Scene
from ._textures import Environment, Texture
from ._typing import Unpack
from .errors import Error, InputError, UsageError

try:
    from pxr import Gf, Tf, Usd, UsdGeom, UsdLux, UsdShade, UsdSkel  # pyright: ignore[reportMissingImports]
except ImportError as error:
    raise ImportError("claray.usd needs the library of USD: pip install usd-core") from error

from . import _usd_geometry as shapes  # noqa: E402
from ._usd_materials import Materials, bound_material  # noqa: E402
from ._usd_panorama import panorama_of, turned  # noqa: E402

__all__ = ["convert", "load"]


def load(path: str | os.PathLike[str], **choices: Unpack[LoadOptions]) -> Scene:
    """Loads a scene of USD, in metres, y upwards. choices: as of claray.load; `time` is seconds from the stage's
    first time code; None: what is there first.

    Warns of what is left out. Raises InputError, naming the file, for a damaged one, and UsageError for a camera that does not exist.
    """
    time = choices.pop("time", None)
    for name in ("animation", "variant", "scene"):
        choice = choices.get(name)
        if choice is not None and not (isinstance(choice, str) and choice == ""):
            raise UsageError(f"{name}: USD has none; leave this option out")
    name = path_of("path", path)
    options = set_all(_native.NativeLoadOptions(), "load", {**choices})
    with tempfile.TemporaryDirectory() as folder:
        made = os.path.join(folder, "scene.glb")
        extra = convert(name, made, time)
        try:
            native, messages, added_light = _native.load(made, options)
        except Error as error:
            raise type(error)(str(error).replace(made, name)) from None
    scene = Scene._of(native, added_light)
    for line in (*extra["warnings"], *(message.replace(made, name) for message in messages)):
        warn(line)
    surroundings = extra["environment"]
    if surroundings or extra["sky"] is not None or extra["suns"]:  # in place of the light that a file of glTF without light gets
        del scene.lights[extra["lights"]:]
        scene.sky, scene.environment = (0, 0, 0), None
    if surroundings:
        scene.environment = Environment(surroundings["image"], surroundings["strength"], surroundings["rotation"])
    elif extra["sky"] is not None:
        scene.sky = tuple(extra["sky"])
    for sun in extra["suns"]:
        scene.add_light(kind="sun", direction=sun["direction"], intensity=sun["irradiance"], outer_angle=sun["angle"])
    return scene


def convert(path: str | os.PathLike[str], glb: str | os.PathLike[str], time: float | None = None) -> dict[str, Any]:
    """Writes a scene of USD as a binary glTF, and returns what glTF lacks: "environment" (image: a claray.Texture, strength, rotation),
    "sky" (radiance, or None) and "suns" (direction, irradiance, angle); also "lights", the number of those in the file, and "warnings".
    time: as of load."""
    name, written = path_of("path", path), path_of("glb", glb)
    moment = None if time is None else number("time", time)
    if not os.path.exists(name):
        raise InputError(f"'{name}' does not exist; check the name")
    try:
        converter = _converter_of(name, moment)
        converter.run()
    except Error:
        raise
    except Tf.ErrorException as error:
        raise InputError(f"'{name}' is no valid USD: {_first_line(error)}; export it again") from None
    except _OF_DAMAGED_FILES as error:
        raise InputError(f"'{name}' is damaged: {type(error).__name__}: {_first_line(error)}; export it again") from error
    with open(written, "wb") as file:
        file.write(converter.glb.bytes())
    return converter.extra


# What the library, NumPy and the conversion raise for values that no exporter writes, such as names that are no UTF-8.
_OF_DAMAGED_FILES = (ArithmeticError, AttributeError, LookupError, MemoryError, RuntimeError, TypeError, ValueError)


def _converter_of(name: str, time: float | None) -> _Converter:
    stage = Usd.Stage.Open(name)
    code = Usd.TimeCode.EarliestTime() if time is None else Usd.TimeCode(stage.GetStartTimeCode() + time * stage.GetTimeCodesPerSecond())
    converter = _Converter(stage, code)
    if stage.HasAuthoredTimeCodeRange() and stage.GetTimeCodesPerSecond() > 0:
        converter.extra["seconds"] = max((stage.GetEndTimeCode() - stage.GetStartTimeCode()) / stage.GetTimeCodesPerSecond(), 0.0)
    return converter


def _first_line(error: Any) -> str:
    """What the library says, without the place in its sources."""
    try:
        said = error.args[0].commentary if isinstance(error, Tf.ErrorException) and error.args else str(error)
    except UnicodeDecodeError:
        return "it has text that is not UTF-8"
    return " ".join(said.split()) or "it cannot be opened"


def _rows(matrix: Any) -> NDArray[np.float64]:
    """A matrix of USD, which multiplies rows, as one that multiplies columns."""
    return np.array(matrix, np.float64).T


class _Converter:
    def __init__(self, stage: Any, time: Any) -> None:
        self.glb = Glb()
        self.extra: dict[str, Any] = {"environment": None, "sky": None, "suns": [], "lights": 0, "warnings": []}
        self._stage, self._time = stage, time
        self._materials = Materials(self.glb, time, self._note)
        self._meshes: dict[Any, int | None] = {}
        unit = UsdGeom.GetStageMetersPerUnit(stage)
        self._root = np.diag([unit, unit, unit, 1.0]) if math.isfinite(unit) and unit > 0 else np.eye(4)
        if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z:
            self._root = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], np.float64) @ self._root

    def _note(self, line: str) -> None:
        if line not in self.extra["warnings"]:
            self.extra["warnings"].append(line)

    def run(self) -> None:
        roots = [prim for prim in self._stage.Traverse() if prim.IsA(UsdSkel.Root)]
        if roots:
            self._stage.SetEditTarget(self._stage.GetSessionLayer())
            value = self._time.GetValue() if self._time.IsNumeric() and not self._time.IsEarliestTime() else self._stage.GetStartTimeCode()
            for root in roots:
                UsdSkel.BakeSkinning(UsdSkel.Root(root), Gf.Interval(value, value))
            self._time = Usd.TimeCode(value)
            self._materials = Materials(self.glb, self._time, self._note)
        self._walk(self._stage.GetPseudoRoot(), self._root)

    def _walk(self, prim: Any, world: NDArray[Any]) -> None:
        """A prim and what is below it. world: from its parent's coordinates."""
        if not prim.IsPseudoRoot():
            if not prim.IsActive() or prim.IsAbstract():
                return
            imageable = UsdGeom.Imageable(prim)
            if imageable:
                if imageable.GetVisibilityAttr().Get(self._time) == UsdGeom.Tokens.invisible:
                    return
                if imageable.ComputePurpose() in (UsdGeom.Tokens.proxy, UsdGeom.Tokens.guide):
                    return
            if prim.IsA(UsdGeom.Xformable):
                form = UsdGeom.Xformable(prim)
                local = _rows(form.GetLocalTransformation(self._time))
                world = (self._root if form.GetResetXformStack() else world) @ local
            if prim.IsA(UsdGeom.PointInstancer):
                self._point_instancer(prim, world)
                return
            self._prim(prim, world)
        for child in prim.GetFilteredChildren(Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)):
            self._walk(child, world)

    def _prim(self, prim: Any, world: NDArray[Any]) -> None:
        if prim.IsA(UsdGeom.Camera):
            self._camera(prim, world)
        elif prim.HasAPI(UsdLux.LightAPI) and not prim.IsA(UsdGeom.Gprim):
            self._light(prim, world)
        elif prim.IsA(UsdGeom.Gprim):
            if prim.HasAPI(UsdLux.LightAPI):
                self._note("lights of meshes (MeshLightAPI) are left out; their meshes are shown")
            number = self._mesh(prim)
            if number is not None:
                self._place(prim.GetName(), world, mesh=number)

    def _place(self, name: str, world: NDArray[Any], **what: int) -> int | None:
        if not np.isfinite(world).all():
            self._note(f"'{name}' has a transform that is not finite, and is left out")
            return None
        return self.glb.add_node({"name": name, "matrix": world.T.ravel().tolist(), **what})

    def _point_instancer(self, prim: Any, world: NDArray[Any]) -> None:
        instancer = UsdGeom.PointInstancer(prim)
        which = instancer.GetProtoIndicesAttr().Get(self._time)
        targets = instancer.GetPrototypesRel().GetForwardedTargets()
        matrices = instancer.ComputeInstanceTransformsAtTime(self._time, self._time, UsdGeom.PointInstancer.IncludeProtoXform,
                                                             UsdGeom.PointInstancer.ApplyMask)
        if not which or not matrices:
            return
        mask = instancer.ComputeMaskAtTime(self._time)
        which = [index for index, shown in zip(which, mask) if shown] if mask else list(which)
        prototypes = [self._stage.GetPrimAtPath(path) for path in targets]
        for index, matrix in zip(which, matrices):
            if not 0 <= index < len(prototypes) or not prototypes[index]:
                self._note(f"'{prim.GetPath()}': an instance has the prototype {index}, which does not exist")
                continue
            prototype = prototypes[index]
            # The prototype's own transform is in the matrix.
            local = _rows(UsdGeom.Xformable(prototype).GetLocalTransformation(self._time)) if prototype.IsA(UsdGeom.Xformable) else np.eye(4)
            try:
                before = np.linalg.inv(local)
            except np.linalg.LinAlgError:
                continue
            self._walk(prototype, world @ _rows(matrix) @ before)

    # Geometry.

    def _mesh(self, prim: Any) -> int | None:
        """The number of the mesh of a prim; None: it has nothing to show."""
        original = prim.GetPrimInPrototype() if prim.IsInstanceProxy() else prim
        subsets = UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets() if prim.IsA(UsdGeom.Mesh) else []
        materials = [self._bound(prim), *(self._bound(subset.GetPrim()) for subset in subsets)]
        key = (str(original.GetPath()), *materials)
        if key not in self._meshes:
            primitives = self._primitives(prim, materials, subsets)
            self._meshes[key] = self.glb.add("meshes", {"name": prim.GetName(), "primitives": primitives}) if primitives else None
        return self._meshes[key]

    def _bound(self, prim: Any) -> int | None:
        material = bound_material(prim)
        return None if material is None else self._materials.number(material)

    def _primitives(self, prim: Any, materials: list[int | None], subsets: list[Any]) -> list[dict[str, Any]]:
        if prim.IsA(UsdGeom.Mesh):
            return self._of_mesh(prim, materials, subsets)
        solid = self._solid(prim)
        if solid is not None:
            points, normals, uvs, faces = solid
            corners = np.arange(len(points))
            return [self._primitive(prim, materials[0], points, faces, normals, corners, faces[:, 0] * 0, uvs)]
        if prim.IsA(UsdGeom.Points) or prim.IsA(UsdGeom.BasisCurves):
            return self._strokes(prim, materials[0])
        self._note(f"'{prim.GetPath()}' is of the type {prim.GetTypeName()}, which is left out")
        return []

    def _solid(self, prim: Any) -> shapes.Solid | None:
        def get(name: str) -> Any:
            return prim.GetAttribute(name).Get(self._time)
        if prim.IsA(UsdGeom.Cube):
            return shapes.cube(get("size"))
        if prim.IsA(UsdGeom.Sphere):
            return shapes.sphere(get("radius"))
        if prim.IsA(UsdGeom.Cylinder):
            return shapes.cylinder(get("radius"), get("height"), get("axis"))
        if prim.IsA(UsdGeom.Cone):
            return shapes.cylinder(get("radius"), get("height"), get("axis"), 0.0)
        if prim.IsA(UsdGeom.Capsule):
            return shapes.capsule(get("radius"), get("height"), get("axis"))
        if prim.IsA(UsdGeom.Plane):
            return shapes.rectangle(get("width"), get("length"), get("axis"))
        return None

    def _strokes(self, prim: Any, material: int | None) -> list[dict[str, Any]]:
        """Points, and the control points of curves as lines. Their widths are the loader's."""
        points = shapes.array_of(UsdGeom.PointBased(prim).GetPointsAttr().Get(self._time), 3)
        if not len(points) or not np.isfinite(points).all():
            return []
        made: dict[str, Any] = {"mode": 0, "attributes": {"POSITION": self.glb.accessor(points, True)}}
        self._note("points and curves have the widths of --stroke-radius")
        if prim.IsA(UsdGeom.BasisCurves):
            counts = np.asarray(UsdGeom.BasisCurves(prim).GetCurveVertexCountsAttr().Get(self._time) or [], np.int64)
            last = np.zeros(len(points), bool)
            last[np.minimum(np.cumsum(counts) - 1, len(points) - 1)] = True
            first = np.flatnonzero(~last[:min(int(counts.sum()), len(points))])
            first = first[first + 1 < len(points)]
            if not len(first):
                return []
            made.update(mode=1, indices=self.glb.accessor(np.stack([first, first + 1], 1).ravel().astype(np.uint32)))
        made["material"] = self._plain_material(prim) if material is None else material
        return [made]

    def _plain_material(self, prim: Any) -> int:
        color = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance("displayColor")
        values = shapes.array_of(color.Get(self._time) if color and color.HasValue() else None, 3)
        opacity = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance("displayOpacity")
        opacities = shapes.array_of(opacity.Get(self._time) if opacity and opacity.HasValue() else None)
        return self._materials.of_color(tuple(values[0].tolist()) if len(values) == 1 else (0.5, 0.5, 0.5) if not len(values) else (1, 1, 1),
                                        float(opacities[0]) if len(opacities) else 1.0)

    def _of_mesh(self, prim: Any, materials: list[int | None], subsets: list[Any]) -> list[dict[str, Any]]:
        mesh = UsdGeom.Mesh(prim)
        points = shapes.array_of(mesh.GetPointsAttr().Get(self._time), 3)
        counts = np.asarray(mesh.GetFaceVertexCountsAttr().Get(self._time) or [], np.int64)
        indices = np.asarray(mesh.GetFaceVertexIndicesAttr().Get(self._time) or [], np.int64)
        if not len(points) or not len(counts):
            return []
        if (counts < 0).any() or counts.sum() != len(indices) or len(indices) and (indices.min() < 0 or indices.max() >= len(points)):
            self._note(f"'{prim.GetPath()}' has faces of vertices that do not exist, and is left out")
            return []
        if not np.isfinite(points).all():
            self._note(f"'{prim.GetPath()}' has vertices that are not finite, and is left out")
            return []
        corners, faces = shapes.triangles_of(counts, np.asarray(mesh.GetHoleIndicesAttr().Get(self._time) or [], np.int64))
        if mesh.GetOrientationAttr().Get(self._time) == UsdGeom.Tokens.leftHanded:
            corners = corners[:, ::-1]
        if not len(corners):
            return []
        normals = self._normals(mesh, points, indices, counts, corners)
        of_face = np.full(len(counts), 0)
        for i, subset in enumerate(subsets):
            given = np.asarray(subset.GetIndicesAttr().Get(self._time) or [], np.int64)
            of_face[given[(given >= 0) & (given < len(counts))]] = i + 1
        made = []
        for part in np.unique(of_face[faces]):
            chosen = of_face[faces] == part
            material = materials[part] if materials[part] is not None else materials[0]
            made.append(self._primitive(prim, material, points[indices], corners[chosen], normals, indices, faces[chosen], None, counts))
        return made

    def _normals(self, mesh: Any, points: NDArray[Any], indices: NDArray[Any], counts: NDArray[Any], corners: NDArray[Any]) -> NDArray[Any] | None:
        """Of each corner; None: flat faces. Subdivision is off: its smooth surface has smooth normals."""
        scheme = mesh.GetSubdivisionSchemeAttr().Get(self._time)
        if scheme != UsdGeom.Tokens.none:
            return shapes.taken(shapes.smooth_normals(points, indices[corners]), indices)
        primvar = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("normals")
        if primvar and primvar.HasValue():
            values, kind = shapes.array_of(primvar.ComputeFlattened(self._time), 3), primvar.GetInterpolation()
        else:
            values, kind = shapes.array_of(mesh.GetNormalsAttr().Get(self._time), 3), mesh.GetNormalsInterpolation()
        spread = self._spread(values, kind, indices, counts)
        return None if spread is None else shapes.unit(spread)

    @staticmethod
    def _spread(values: NDArray[Any], kind: str, indices: NDArray[Any], counts: NDArray[Any]) -> NDArray[Any] | None:
        """A primvar's values for each corner, or None if their number does not fit."""
        points = int(indices.max()) + 1 if len(indices) else 0
        if kind in ("vertex", "varying") and len(values) >= points:
            return shapes.taken(values, indices)
        if kind == "faceVarying" and len(values) == len(indices):
            return values
        if kind == "uniform" and len(values) == len(counts):
            return np.repeat(values, counts, 0)
        if kind == "constant" and len(values) >= 1:
            return np.repeat(values[:1], len(indices), 0)
        return None

    def _primvar(self, prim: Any, name: str, columns: int, indices: NDArray[Any], counts: NDArray[Any] | None) -> NDArray[Any] | None:
        primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(name)
        if not primvar or not primvar.HasValue():
            return None
        try:
            values = shapes.array_of(primvar.ComputeFlattened(self._time), columns)
        except ValueError:
            return None
        return self._spread(values, primvar.GetInterpolation(), indices, np.zeros(0, np.int64) if counts is None else counts)

    def _primitive(self, prim: Any, material: int | None, points: NDArray[Any], corners: NDArray[Any], normals: NDArray[Any] | None,
                   indices: NDArray[Any], faces: NDArray[Any], own_uvs: NDArray[Any] | None, counts: NDArray[Any] | None = None) -> dict[str, Any]:
        """points, normals: of each corner. corners: of triangles. indices: the vertex of each corner."""
        attributes: dict[str, NDArray[Any]] = {"POSITION": points}
        if normals is not None:
            attributes["NORMAL"] = normals
        colors = None
        if material is None:
            colors = self._primvar(prim, "displayColor", 3, indices, counts)
            if colors is None:
                material = self._plain_material(prim)
            elif bool((colors == colors[:1]).all()):
                material, colors = self._materials.of_color(tuple(colors[0].tolist()), self._opacity(prim)), None
            else:
                material = self._materials.of_color((1, 1, 1), self._opacity(prim))
        elif material in self._materials.color_names:
            colors = self._primvar(prim, self._materials.color_names[material], 3, indices, counts)
        if colors is not None:
            attributes["COLOR_0"] = np.clip(colors, 0, 1)
        for i, name in enumerate(self._materials.uv_names.get(material, [])):
            uvs = own_uvs if own_uvs is not None else self._primvar(prim, name, 2, indices, counts)
            if uvs is None:
                self._note(f"'{prim.GetPath()}' has no coordinates '{name}', which its material reads")
                uvs = np.zeros((len(points), 2), np.float32)
            attributes[f"TEXCOORD_{i}"] = uvs * np.array([1, -1], np.float32) + np.array([0, 1], np.float32)  # glTF's v runs downwards
        used, numbers = np.unique(corners, return_inverse=True)
        stored = {key: self.glb.accessor(np.ascontiguousarray(values[used], np.float32), key == "POSITION") for key, values in attributes.items()}
        return {"attributes": stored, "indices": self.glb.accessor(numbers.ravel().astype(np.uint32)), "material": material}

    def _opacity(self, prim: Any) -> float:
        primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance("displayOpacity")
        values = shapes.array_of(primvar.Get(self._time) if primvar and primvar.HasValue() else None)
        return float(values[0]) if len(values) else 1.0

    # Cameras and lights.

    def _camera(self, prim: Any, world: NDArray[Any]) -> None:
        camera = UsdGeom.Camera(prim).GetCamera(self._time)
        scale = float(np.cbrt(abs(np.linalg.det(world[:3, :3]))))
        if camera.projection == Gf.Camera.Orthographic:
            half = camera.verticalAperture * Gf.Camera.APERTURE_UNIT / 2 * scale
            made: dict[str, Any] = {"type": "orthographic", "orthographic": {"xmag": max(half, 1e-6), "ymag": max(half, 1e-6), "znear": 0.01,
                                                                             "zfar": 1000.0}}
        else:
            angle = math.radians(camera.GetFieldOfView(Gf.Camera.FOVVertical))
            made = {"type": "perspective", "perspective": {"yfov": min(max(angle, 1e-3), 3.1), "znear": 0.01}}
        if camera.fStop > 0:
            self._note(f"camera '{prim.GetName()}': depth of field is left out")
        if camera.horizontalApertureOffset or camera.verticalApertureOffset:
            self._note(f"camera '{prim.GetName()}': its shift is left out")
        made["name"] = prim.GetName()
        rigid = world.copy()
        rigid[:3, :3] /= np.maximum(np.linalg.norm(world[:3, :3], axis=0), 1e-30)
        self._place(prim.GetName(), rigid, camera=self.glb.add("cameras", made))

    def _radiance(self, light: Any) -> NDArray[np.float64]:
        """Intensity, exposure, colour and temperature (UsdLux, "LightAPI")."""
        color = np.array(light.GetColorAttr().Get(self._time), np.float64)
        if light.GetEnableColorTemperatureAttr().Get(self._time):
            color *= np.array(UsdLux.BlackbodyTemperatureAsRgb(light.GetColorTemperatureAttr().Get(self._time)))
        radiance: NDArray[np.float64] = np.maximum(color * light.GetIntensityAttr().Get(self._time) * 2.0 ** light.GetExposureAttr().Get(self._time), 0)
        return radiance

    def _light(self, prim: Any, world: NDArray[Any]) -> None:
        light = UsdLux.LightAPI(prim)
        radiance, name = self._radiance(light), prim.GetName()
        if not radiance.any() or not np.isfinite(radiance).all():
            return
        normalized = bool(light.GetNormalizeAttr().Get(self._time))

        def get(attribute: str) -> Any:
            return prim.GetAttribute("inputs:" + attribute).Get(self._time)
        if prim.IsA(UsdLux.DomeLight) or prim.GetTypeName() == "DomeLight_1":
            self._dome(prim, world, radiance)
        elif prim.IsA(UsdLux.DistantLight):
            half = math.radians(get("angle")) / 2
            irradiance = radiance if normalized or half < 1e-4 else radiance * math.pi * math.sin(half) ** 2
            self._far_light(name, world, irradiance, half)
        elif prim.IsA(UsdLux.SphereLight):
            radius = get("radius") * float(np.cbrt(abs(np.linalg.det(world[:3, :3]))))
            cone = prim.GetAttribute("inputs:shaping:cone:angle")
            spread = cone.Get(self._time) if cone and prim.HasAPI(UsdLux.ShapingAPI) else None
            if normalized and radius > 0:
                radiance = radiance / (4 * math.pi * radius ** 2)
            if spread is not None and spread < 90 or prim.GetAttribute("treatAsPoint").Get(self._time) or radius <= 0:
                intensity = radiance * (math.pi * radius ** 2 if radius > 0 else 1.0)
                self._near_light(name, world, intensity, spread, prim)
            else:
                self._lamp(prim, world, shapes.sphere(get("radius")), radiance, False)
        elif prim.IsA(UsdLux.RectLight):
            if prim.GetAttribute("inputs:texture:file").Get(self._time):
                self._note(f"light '{name}': its image is left out")
            self._lamp(prim, world, shapes.rectangle(get("width"), get("height"), down=True), radiance, normalized)
        elif prim.IsA(UsdLux.DiskLight):
            self._lamp(prim, world, shapes.disc(get("radius"), down=True), radiance, normalized)
        elif prim.IsA(UsdLux.CylinderLight):
            self._lamp(prim, world, shapes.cylinder(get("radius"), get("length"), "X"), radiance, normalized)
        else:
            self._note(f"light '{name}' is of the type {prim.GetTypeName()}, which is left out")

    def _lamp(self, prim: Any, world: NDArray[Any], solid: shapes.Solid, radiance: NDArray[Any], normalized: bool) -> None:
        points, normals, _, faces = solid
        if normalized:
            placed = points @ world[:3, :3].T
            a, b, c = (placed[faces[:, i]] for i in range(3))
            radiance = radiance / max(float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2), 1e-30)
        primitive = {"attributes": {"POSITION": self.glb.accessor(points, True), "NORMAL": self.glb.accessor(normals)},
                     "indices": self.glb.accessor(faces.ravel().astype(np.uint32)), "material": self._materials.of_light(radiance)}
        self._place(prim.GetName(), world, mesh=self.glb.add("meshes", {"name": prim.GetName(), "primitives": [primitive]}))
        if prim.HasAPI(UsdLux.ShapingAPI) and (prim.GetAttribute("inputs:shaping:cone:angle").Get(self._time) or 90) < 90:
            self._note(f"light '{prim.GetName()}': the cone of a surface is left out")

    def _punctual(self, name: str, world: NDArray[Any], light: dict[str, Any], intensity: NDArray[Any]) -> None:
        largest = float(intensity.max())
        light.update(name=name, intensity=largest, color=(intensity / largest).tolist())
        rigid = world.copy()
        rigid[:3, :3] /= np.maximum(np.linalg.norm(world[:3, :3], axis=0), 1e-30)
        node = self._place(name, rigid)
        if node is not None:
            self.glb.extension(self.glb.json, "KHR_lights_punctual").setdefault("lights", []).append(light)
            self.glb.json["nodes"][node]["extensions"] = {"KHR_lights_punctual": {"light": self.extra["lights"]}}
            self.extra["lights"] += 1

    def _near_light(self, name: str, world: NDArray[Any], intensity: NDArray[Any], spread: float | None, prim: Any) -> None:
        light: dict[str, Any] = {"type": "point"}
        if spread is not None and spread < 90:
            soft = prim.GetAttribute("inputs:shaping:cone:softness").Get(self._time) or 0.0
            outer = math.radians(max(float(spread), 0.1))
            light = {"type": "spot", "spot": {"outerConeAngle": outer, "innerConeAngle": min(outer * (1 - min(max(float(soft), 0.0), 1.0)), outer * 0.999)}}
        self._punctual(name, world, light, intensity)

    def _far_light(self, name: str, world: NDArray[Any], irradiance: NDArray[Any], half: float) -> None:
        if half < 1e-4:
            self._punctual(name, world, {"type": "directional"}, irradiance)
            return
        direction = -world[:3, 2] / np.linalg.norm(world[:3, 2])
        self.extra["suns"].append({"direction": direction.tolist(), "irradiance": irradiance.tolist(), "angle": min(half, math.pi / 2)})

    def _dome(self, prim: Any, world: NDArray[Any], radiance: NDArray[Any]) -> None:
        file = prim.GetAttribute("inputs:texture:file").Get(self._time)
        path = file.resolvedPath if file is not None else ""
        if file is not None and file.path and not path:
            self._note(f"the image '{file.path}' is missing")
        if not path:
            before = self.extra["sky"] or [0, 0, 0]
            self.extra["sky"] = [float(a + b) for a, b in zip(before, radiance)]
            return
        layout = str(prim.GetAttribute("inputs:texture:format").Get(self._time))
        if layout not in ("automatic", "latlong"):
            self._note(f"the dome's format {layout} counts as latlong")
        if self.extra["environment"]:
            self._note("of several domes with images the first is used")
            return
        pixels = panorama_of(path)
        turn = world[:3, :3] / np.maximum(np.linalg.norm(world[:3, :3], axis=0), 1e-30)
        pole = prim.GetAttribute("poleAxis").Get(self._time) if prim.GetTypeName() == "DomeLight_1" else None
        if pole == UsdGeom.Tokens.z or pole == "scene" and UsdGeom.GetStageUpAxis(self._stage) == UsdGeom.Tokens.z:
            turn = turn @ np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], np.float64)
        # The middle of USD's image is towards +z, +y upwards; that of claray's towards -z.
        turn = turn @ np.diag([-1.0, 1.0, -1.0])
        pixels = pixels[..., :3].astype(np.float32) * radiance.astype(np.float32)
        if abs(turn[1, 1] - 1) > 1e-4:
            pixels, angle = turned(pixels, turn), 0.0
        else:
            angle = math.atan2(turn[0, 2], turn[2, 2])
        self.extra["environment"] = {"image": Texture(pixels, "linear", "repeat"), "strength": 1.0, "rotation": angle}


def main(arguments: list[str]) -> None:
    """For the program `claray`: FILE OUT.glb [SECONDS]. Writes also OUT.json with what convert returns; the image around the scene is in
    OUT.pfm. The library's own messages are left out."""
    path, glb = arguments[:2]
    stem = os.path.splitext(glb)[0]
    errors, nothing = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 2)
    try:
        extra = convert(path, glb, float(arguments[2]) if len(arguments) > 2 else None)
    except Error as problem:
        os.dup2(errors, 2)
        sys.exit(str(problem).rpartition("; ")[0])  # the program has a remedy of its own
    finally:
        os.dup2(errors, 2)
    if extra["environment"]:
        extra["environment"].pop("image").save(stem + ".pfm")
        extra["environment"]["file"] = stem + ".pfm"
    with open(stem + ".json", "w", encoding="utf-8") as file:
        json.dump(extra, file)


if __name__ == "__main__":
    main(sys.argv[1:])
