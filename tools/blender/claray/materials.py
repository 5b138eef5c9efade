# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials of Blender as those of claray, whose kind "principled" has glTF's terms."""

from dataclasses import dataclass, field, replace

import claray
import numpy as np

from .nodes import Tree, VertexColor
from .values import Value, combined, constant

WHITE, BLACK = (1.0, 1.0, 1.0, 1.0), (0.0, 0.0, 0.0, 1.0)


@dataclass
class Surface:
    """What a shader gives. plain: properties of claray.Material that are numbers and colours."""

    kind: str = "lambert"
    color: object = field(default_factory=lambda: constant(BLACK))  # a Value of 4 channels, or a VertexColor
    emission: Value = field(default_factory=lambda: constant(BLACK))
    strength: float = 0.0  # of the emission
    opacity: Value = field(default_factory=lambda: constant(1.0))
    metallic: Value = field(default_factory=lambda: constant(0.0))
    roughness: Value = field(default_factory=lambda: constant(0.0))
    transmission: Value = field(default_factory=lambda: constant(0.0))
    clearcoat: Value = field(default_factory=lambda: constant(0.0))
    normal: object = None  # the node of a normal map or of bumps
    plain: dict = field(default_factory=dict)

    @property
    def reflects(self):
        return self.kind != "lambert" or isinstance(self.color, VertexColor) or not self.color.is_constant or self.color.data[:3].any()


class Shaders:
    """Reads the shader nodes of a Tree."""

    def __init__(self, tree):
        self._tree, self.note = tree, tree.note

    def at(self, socket):
        """The surface that an input of shaders gets; None: nothing is connected."""
        output, _, groups = self._tree.source(socket)
        if output is None:
            return None
        with self._tree.within(groups):
            node = output.node
            read = getattr(self, node.bl_idname.removeprefix("ShaderNode"), None)
            if read is None:
                self.note(f"the shader '{node.bl_label}' is not known; a grey one takes its place")
                return Surface(color=constant((0.5, 0.5, 0.5, 1.0)))
            return read(node)

    def _normal(self, node, name="Normal"):
        output, _, groups = self._tree.source(node.inputs[name])
        if output is None:
            return None
        if output.node.bl_idname in ("ShaderNodeNormalMap", "ShaderNodeBump"):
            return output.node, groups
        self.note(f"the node '{output.node.bl_label}' as a normal is left out")
        return None

    def _value(self, node, name, channels=1, vertex_colors=False):
        return self._tree.value(node.inputs[name], channels, vertex_colors)

    def BsdfPrincipled(self, node):
        number, color = self._tree.number, self._tree.color
        plain = {"ior": max(number(node, "IOR"), 1e-3), "clearcoat_roughness": number(node, "Coat Roughness")}
        level, tint = 2 * number(node, "Specular IOR Level"), color(node, "Specular Tint")
        if level <= 0:
            plain["specular_weight"] = 0.0
        elif level != 1 or (tint != 1).any():
            plain["specular_tint"] = level * tint
        sheen = min(number(node, "Sheen Weight"), 1.0)
        if sheen > 0:
            plain.update(sheen=np.clip(sheen * color(node, "Sheen Tint"), 0, 1), sheen_roughness=number(node, "Sheen Roughness"))
        if (stretch := number(node, "Anisotropic")) != 0:
            # Cycles' aspect is sqrt(1 - 0.9 a): its roughness along the tangent is alpha / aspect, which glTF's strength gives.
            alpha = max(number(node, "Roughness"), 1e-3) ** 2
            along = min(alpha / (1 - 0.9 * min(abs(stretch), 1)) ** 0.5, 1.0)
            plain.update(anisotropy=max(0.0, (along - alpha) / max(1 - alpha, 1e-3)) ** 0.5,
                         anisotropy_rotation=2 * np.pi * number(node, "Anisotropic Rotation"))
            self.note("highlights are stretched as in glTF, not as in Cycles")
        if (film := number(node, "Thin Film Thickness")) > 0:
            plain.update(iridescence=1.0, film_thickness=(film, film), iridescence_ior=number(node, "Thin Film IOR"))
        for name, text in (("Subsurface Weight", "light below the surface (subsurface)"), ("Diffuse Roughness", "the roughness of the diffuse part")):
            if name in node.inputs and number(node, name) > 0:
                self.note(f"{text} is left out")
        coat = self._value(node, "Coat Weight")
        if coat.mean()[0] > 0:
            if (color(node, "Coat Tint") != 1).any():
                self.note("the tint of a coat is left out")
            if abs(number(node, "Coat IOR") - 1.5) > 1e-3:
                self.note("a coat has the index of refraction 1.5")
        return Surface("principled", self._value(node, "Base Color", 4, True), self._value(node, "Emission Color", 4),
                       number(node, "Emission Strength"), self._value(node, "Alpha"), self._value(node, "Metallic"),
                       self._value(node, "Roughness"), self._value(node, "Transmission Weight"), coat, self._normal(node), plain)

    def BsdfDiffuse(self, node):
        rough = self._value(node, "Roughness")
        return Surface("oren-nayar" if rough.mean()[0] > 0 else "lambert", self._value(node, "Color", 4, True), roughness=rough,
                       normal=self._normal(node))

    def BsdfAnisotropic(self, node):
        """The Glossy BSDF."""
        rough = self._value(node, "Roughness")
        if self._tree.number(node, "Anisotropy"):
            self.note("the anisotropy of a Glossy BSDF is left out")
        return Surface("metal" if rough.mean()[0] > 0 else "mirror", self._value(node, "Color", 4, True), roughness=rough,
                       normal=self._normal(node))

    BsdfGlossy = BsdfAnisotropic

    def BsdfMetallic(self, node):
        if "Base Color" not in node.inputs or not node.inputs["Base Color"].enabled:
            self.note("a metal by its conductor's numbers is left out; grey takes its place")
            return Surface("metal", constant((0.5, 0.5, 0.5, 1.0)), roughness=self._value(node, "Roughness"), normal=self._normal(node))
        return Surface("metal", self._value(node, "Base Color", 4, True), roughness=self._value(node, "Roughness"), normal=self._normal(node))

    def BsdfGlass(self, node):
        return Surface("glass", self._value(node, "Color", 4), roughness=self._value(node, "Roughness"),
                       normal=self._normal(node), plain={"ior": max(self._tree.number(node, "IOR"), 1e-3)})

    def BsdfRefraction(self, node):
        self.note("a Refraction BSDF counts as glass, which reflects, too")
        return self.BsdfGlass(node)

    def BsdfTransparent(self, node):
        tint = self._tree.color(node, "Color")
        if (tint != 1).any():
            self.note("the colour of a Transparent BSDF counts as opacity")
        return Surface(opacity=constant(1 - float(np.clip(tint.mean(), 0, 1))))

    def Emission(self, node):
        return Surface(emission=self._value(node, "Color", 4), strength=self._tree.number(node, "Strength"))

    Background = Emission

    def BsdfSheen(self, node):
        return Surface("principled", constant(BLACK), plain={"specular_weight": 0.0, "sheen": np.clip(self._tree.color(node, "Color"), 0, 1),
                                                             "sheen_roughness": self._tree.number(node, "Roughness")})

    def SubsurfaceScattering(self, node):
        self.note("light below the surface (subsurface) is left out")
        return Surface(color=self._value(node, "Color", 4, True), normal=self._normal(node))

    def BsdfTranslucent(self, node):
        self.note("a Translucent BSDF counts as diffuse")
        return Surface(color=self._value(node, "Color", 4, True), normal=self._normal(node))

    def AddShader(self, node):
        a, b = (self.at(socket) or Surface() for socket in node.inputs[:2])
        if a.reflects and b.reflects:
            self.note("an Add Shader of two surfaces counts as the first")
        first, other = (a, b) if a.reflects else (b, a)
        return self._with_emission(first, other, 1.0)

    def MixShader(self, node):
        share = self._tree.value(node.inputs[0], 1)
        a, b = (self.at(socket) or Surface() for socket in node.inputs[1:3])
        clear = [self._is_clear(surface) for surface in (a, b)]
        if clear[0] != clear[1]:
            visible = b if clear[0] else a
            seen = (lambda f, v, w: f * w + (1 - f) * v) if clear[0] else (lambda f, v, w: (1 - f) * w + f * v)
            opacity = self._tree.combined(seen, share, (a if clear[0] else b).opacity, visible.opacity)
            return replace(visible, opacity=opacity)
        if not share.is_constant:
            self.note("shaders are mixed by the mean of an image")
        factor = float(np.clip(share.mean()[0], 0, 1))
        if a.reflects and b.reflects:
            if a.kind == b.kind and not isinstance(a.color, VertexColor) and not isinstance(b.color, VertexColor):
                return self._mixed(factor, a, b)
            self.note(f"a mix of the shaders {a.kind} and {b.kind} counts as the one with the larger share")
            return b if factor > 0.5 else a
        first, other, weight = (a, b, factor) if a.reflects else (b, a, 1 - factor)
        if not isinstance(first.color, VertexColor):
            first = replace(first, color=self._tree.combined(lambda c: c * np.array([1 - weight] * 3 + [1], np.float32), first.color))
        return self._with_emission(first, other, weight)

    @staticmethod
    def _is_clear(surface):
        return not surface.reflects and surface.strength == 0 and surface.opacity.is_constant and surface.opacity.data[0] < 1

    def _with_emission(self, surface, other, share):
        if surface.strength == 0:
            return replace(surface, emission=other.emission, strength=other.strength * share)
        if other.strength == 0:
            return surface
        sum_of_both = self._tree.combined(lambda x, y: surface.strength * x + share * other.strength * y, surface.emission, other.emission)
        return replace(surface, emission=sum_of_both, strength=1.0)

    def _mixed(self, factor, a, b):
        def mix(x, y):
            return self._tree.combined(lambda v, w: v + factor * (w - v), x, y)
        names = ("color", "opacity", "metallic", "roughness", "transmission", "clearcoat")
        plain = {**a.plain, **b.plain}
        for name in set(a.plain) & set(b.plain):
            plain[name] = np.asarray(a.plain[name]) + factor * (np.asarray(b.plain[name]) - np.asarray(a.plain[name]))
        if set(a.plain) != set(b.plain):
            self.note("a mix of two shaders has the layers of both")
        emission = mix(replace(a.emission, data=a.emission.data * a.strength, image=None),
                       replace(b.emission, data=b.emission.data * b.strength, image=None))
        return replace(a, emission=emission, strength=1.0, plain=plain, **{name: mix(getattr(a, name), getattr(b, name)) for name in names})


class Textures:
    """The images of a claray.Scene; an image that is used unchanged is there once."""

    def __init__(self, scene):
        self._scene, self._numbers = scene, {}

    def color(self, value):
        """The number of a texture with the colours of a value."""
        key = None if value.image is None else (value.image.session_uid, value.place.wrap, value.place.filter)
        if key is None or key not in self._numbers:
            number = self._add(value.place, *_bytes_or_floats(value.data[..., :3], value.image))
            if key is None:
                return number
            self._numbers[key] = number
        return self._numbers[key]

    def numbers(self, value, texels):
        """The number of a texture of numbers. texels: (H, W, C); value: where they lie."""
        return self._add(value.place, texels, "linear")

    def _add(self, place, pixels, color):
        return self._scene.add_texture(claray.Texture(np.ascontiguousarray(pixels), color, place.wrap, place.filter))


def _bytes_or_floats(texels, image):
    """Texels of an image of bytes as bytes, which need a quarter of the memory. Blender's bytes are decoded already: they are encoded
    again, which gives the same bytes."""
    if image is None or image.is_float:
        return texels, "linear"
    if image.colorspace_settings.name != "sRGB":
        return np.rint(texels * 255).astype(np.uint8), "linear"
    encoded = np.where(texels <= 0.0031308, texels * 12.92, 1.055 * np.maximum(texels, 1e-8) ** (1 / 2.4) - 0.055)
    return np.rint(encoded * 255).astype(np.uint8), "srgb"


class Materials:
    """The materials of a claray.Scene, each of Blender's once."""

    def __init__(self, scene, report):
        self._scene, self._report = scene, report
        self._textures, self._images = Textures(scene), {}
        self._numbers, self.uv_maps, self.vertex_colors = {}, {}, {}

    def number(self, material):
        """The number of a material; None: Blender's default. Its UV maps are in uv_maps[number], empty: it has no texture, and the name
        of its vertex colours in vertex_colors[number]."""
        key = None if material is None else material.original.session_uid
        if key not in self._numbers:
            name = "" if material is None else material.name
            used, colors = [], None
            properties = {"kind": "lambert", "albedo": (0.8, 0.8, 0.8)}
            if material is not None:
                def note(text):
                    self._report.note(f"material '{name}'", text)
                surface, tree = self._surface(material, note)
                if isinstance(surface.color, VertexColor):
                    colors = surface.color.name
                properties = self._properties(surface, tree, note, used)
            number = self._scene.add_material(name=name, **properties)
            self._numbers[key], self.uv_maps[number], self.vertex_colors[number] = number, used, colors
        return self._numbers[key]

    def _surface(self, material, note):
        tree = material.node_tree if material.use_nodes else None
        if tree is None:
            color = constant((*material.diffuse_color[:3], 1.0))
            return Surface("principled", color, metallic=constant(material.metallic), roughness=constant(material.roughness)), None
        nodes = Tree(tree, note, self._images)
        output = nodes.output("ShaderNodeOutputMaterial")
        if output is None:
            return Surface(), nodes
        for name, text in (("Volume", "a volume"), ("Displacement", "displacement")):
            if nodes.source(output.inputs[name])[0] is not None:
                note(f"{text} is left out")
        return Shaders(nodes).at(output.inputs["Surface"]) or Surface(), nodes

    def _properties(self, surface, tree, note, used):
        """The properties of claray.Material. used: gets the names of UV maps."""
        properties = {"kind": surface.kind, **surface.plain}

        def use(number, place):
            if place.uv_map not in used:
                if len(used) == 2:
                    note(f"a third UV map, '{place.uv_map}'; the first one takes its place")
                    return claray.TextureUse(number, 0)
                used.append(place.uv_map)
            return _texture_use(number, place, used.index(place.uv_map))

        def number_or_map(name, value, map_name, channel):
            if value.is_constant:
                properties[name] = float(np.clip(value.data[0], 0, 1))
                return
            texels = np.zeros((*value.data.shape[:2], 3), np.float32)
            texels[..., channel] = np.clip(value.data[..., 0], 0, 1)
            properties[name], properties[map_name] = 1.0, use(self._textures.numbers(value, texels), value.place)

        if isinstance(surface.color, VertexColor):
            properties["albedo"] = WHITE[:3]
        elif surface.color.is_constant:
            properties["albedo"] = np.clip(surface.color.data[:3], 0, 1)
        else:
            properties["albedo"] = WHITE[:3]
            properties["albedo_map"] = use(self._textures.color(surface.color), surface.color.place)
        if surface.strength > 0:
            if surface.emission.is_constant:
                properties["emission"] = np.maximum(surface.strength * surface.emission.data[:3], 0)
            else:
                properties["emission"] = [surface.strength] * 3
                properties["emission_map"] = use(self._textures.color(surface.emission), surface.emission.place)
        if not surface.opacity.is_constant or surface.opacity.data[0] < 1:
            properties["alpha_mode"] = "blend"
            number_or_map("opacity", surface.opacity, "opacity_map", 0)
        self._roughness_and_metallic(surface, properties, use, note)
        if surface.kind == "principled":
            number_or_map("transmission", surface.transmission, "transmission_map", 0)
            number_or_map("clearcoat", surface.clearcoat, "clearcoat_map", 0)
        if surface.normal is not None:
            self._normal(surface.normal, properties, tree, use, note)
        return properties

    def _roughness_and_metallic(self, surface, properties, use, note):
        if surface.kind in ("lambert", "mirror"):
            return
        rough, metal = surface.roughness, surface.metallic
        if rough.is_constant and metal.is_constant:
            properties["roughness"] = float(np.clip(rough.data[0], 0, 1))
            if surface.kind == "principled":
                properties["metallic"] = float(np.clip(metal.data[0], 0, 1))
            return
        both = combined_texels(rough, metal, note)
        properties["roughness"] = 1.0
        if surface.kind == "principled":
            properties["metallic"] = 1.0
        properties["metallic_roughness_map"] = use(self._textures.numbers(both, both.data), both.place)

    def _normal(self, given, properties, tree, use, note):
        node, groups = given
        with tree.within(groups):
            if node.bl_idname == "ShaderNodeNormalMap":
                color = tree.value(node.inputs["Color"], 4)
                if node.space != "TANGENT":
                    note(f"a normal map in the space {node.space.lower()} is left out")
                elif not color.is_constant:
                    properties["normal_map"] = use(self._textures.color(color), color.place)
                    properties["normal_scale"] = tree.number(node, "Strength")
                return
            height = tree.value(node.inputs["Height"], 1)
            if node.inputs["Normal"].is_linked:
                note("the normal that a Bump node gets is left out")
            if height.is_constant:
                return
            sign = -1 if node.invert else 1
            properties["height_map"] = use(self._textures.numbers(height, height.data), height.place)
            properties["height_scale"] = sign * tree.number(node, "Strength") * tree.number(node, "Distance")


def combined_texels(rough, metal, note):
    """Green has the roughness, blue the metallic."""
    return combined(lambda r, m: np.concatenate(np.broadcast_arrays(np.zeros_like(r + m), np.clip(r, 0, 1) + 0 * m,
                                                                    np.clip(m, 0, 1) + 0 * r), -1), [rough, metal], note)


def _texture_use(number, place, uv_set):
    """claray's v runs downwards: v' = 1 - v on both sides of the mapping."""
    c, s = np.cos(place.rotation), np.sin(place.rotation)
    (sx, sy), (tx, ty) = place.scale, place.offset
    return claray.TextureUse(number, uv_set, (float(tx - s * sy), float(1 - c * sy - ty)), (sx, sy), float(place.rotation))
