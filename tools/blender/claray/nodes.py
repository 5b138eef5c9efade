# SPDX-License-Identifier: GPL-3.0-or-later
"""What a node tree gives at its sockets: values (values.py)."""

import math
from dataclasses import replace

import numpy as np

from . import values
from .values import Place, Value, as_channels, combined, constant

WRAPS = {"REPEAT": "repeat", "EXTEND": "clamp", "CLIP": "clamp", "MIRROR": "mirror"}


class VertexColor:
    """The colours of vertices, which only a base colour can be."""

    def __init__(self, name):
        self.name = name


class Tree:
    """Evaluates the nodes of one material, world or light. note(text) tells what is lost; images: linear texels of images that were read
    already, by their identifiers."""

    def __init__(self, tree, note, images):
        self.tree, self.note, self._images = tree, note, images
        self._groups = []  # nodes of the groups that are being evaluated, from outside to inside
        self._done = {}

    def output(self, kind):
        """The active node of output, or None."""
        return self.tree.get_output_node("CYCLES") or self.tree.get_output_node("ALL") \
            if kind == "ShaderNodeOutputMaterial" else next(
                (node for node in self.tree.nodes if node.bl_idname == kind and node.is_active_output), None)

    def source(self, socket):
        """The output socket that feeds an input, through reroutes and groups, with the groups it lies in; (None, input, groups) where
        nothing does."""
        groups = list(self._groups)
        while True:
            if not socket.is_linked or not socket.links[0].is_valid or socket.links[0].is_muted:
                return None, socket, groups
            output = socket.links[0].from_socket
            node = output.node
            if node.mute and node.bl_idname != "NodeReroute":
                inside = next((link.from_socket for link in node.internal_links if link.to_socket == output), None)
                if inside is None:
                    return None, socket, groups
                socket = inside
            elif node.bl_idname == "NodeReroute":
                socket = node.inputs[0]
            elif node.bl_idname == "ShaderNodeGroup" and node.node_tree:
                inner = next((n for n in node.node_tree.nodes if n.bl_idname == "NodeGroupOutput" and n.is_active_output), None)
                if inner is None:
                    return None, socket, groups
                groups.append(node)
                socket = next(s for s in inner.inputs if s.identifier == output.identifier)
            elif node.bl_idname == "NodeGroupInput" and groups:
                socket = next(s for s in groups.pop().inputs if s.identifier == output.identifier)
            else:
                return output, socket, groups

    def within(self, groups):
        """The context of the nodes of groups."""
        return _Within(self, groups)

    def value(self, socket, channels, vertex_colors=False):
        """The value of an input. channels: 1, 3 or 4. vertex_colors: whether it may be a VertexColor."""
        output, unlinked, groups = self.source(socket)
        if output is None:
            given = self._default(unlinked)
        else:
            with self.within(groups):
                given = self._of_output(output)
        if isinstance(given, VertexColor):
            if vertex_colors:
                return given
            self.note("colours of vertices are used only directly as a base colour; grey takes their place")
            given = constant((0.5, 0.5, 0.5, 1.0))
        return as_channels(given, channels)

    def number(self, node, name):
        """The value of an input as one number: the mean of an image."""
        return float(self._mean(node, name, 1)[0])

    def color(self, node, name):
        """The value of an input as one colour: the mean of an image."""
        return self._mean(node, name, 4)[:3]

    def _mean(self, node, name, channels):
        given = self.value(node.inputs[name], channels)
        if not given.is_constant:
            self.note(f"an image as '{name}' counts with its mean")
        return given.mean()

    def _default(self, socket):
        default = getattr(socket, "default_value", 0.0)
        return constant(tuple(default) if hasattr(default, "__len__") else float(default))

    def _of_output(self, output):
        key = (tuple(id(group) for group in self._groups), output.node.as_pointer(), output.identifier)
        if key not in self._done:
            function = _NODES.get(output.node.bl_idname)
            if function is None:
                self.note(f"the node '{output.node.bl_label}' is not known; its place takes a default value")
                self._done[key] = self._default(output)
            else:
                self._done[key] = function(self, output.node, output)
        return self._done[key]

    def combined(self, function, *given):
        return combined(function, given, self.note)

    def texels(self, image):
        key = image.session_uid
        if key not in self._images:
            self._images[key] = values.linear_texels(image)
        return self._images[key]

    def place(self, node):
        """Where the image of a node lies."""
        place = Place(wrap=WRAPS.get(node.extension, "repeat"), filter="nearest" if node.interpolation == "Closest" else "trilinear")
        if node.extension == "CLIP":
            self.note("images that are clipped are continued by their border")
        if node.projection != "FLAT":
            self.note(f"the projection {node.projection.lower()} of an image; its UV map is used")
        return self._mapped(place, node.inputs["Vector"])

    def _mapped(self, place, socket):
        output, socket, groups = self.source(socket)
        if output is None:
            return place
        node = output.node
        with self.within(groups):
            if node.bl_idname == "ShaderNodeUVMap":
                return replace(place, uv_map=node.uv_map)
            if node.bl_idname == "ShaderNodeAttribute" and node.attribute_type == "GEOMETRY":
                return replace(place, uv_map=node.attribute_name)
            if node.bl_idname == "ShaderNodeTexCoord" and output.name == "UV":
                return place
            if node.bl_idname == "ShaderNodeMapping":
                inner = self._mapped(place, node.inputs["Vector"])
                if (inner.offset, inner.scale, inner.rotation) != ((0.0, 0.0), (1.0, 1.0), 0.0):
                    self.note("a mapping of a mapping; the inner one is left out")
                return _mapping(self, node, inner)
        self.note(f"the coordinates '{output.name}' of the node '{node.bl_label}'; the UV map is used")
        return place


class _Within:
    def __init__(self, tree, groups):
        self._tree, self._groups = tree, groups

    def __enter__(self):
        self._kept, self._tree._groups = self._tree._groups, self._groups

    def __exit__(self, *raised):
        self._tree._groups = self._kept


def _mapping(tree, node, place):
    location, rotation, scale = (tree.value(node.inputs[name], 3).mean() if name in node.inputs and node.inputs[name].enabled
                                 else np.full(3, float(name == "Scale"), np.float32) for name in ("Location", "Rotation", "Scale"))
    if node.vector_type not in ("POINT", "TEXTURE") or rotation[0] or rotation[1]:
        tree.note("a mapping other than of points and textures about z; only what is about z counts")
    if node.vector_type != "TEXTURE":
        return replace(place, offset=tuple(map(float, location[:2])), scale=tuple(map(float, scale[:2])), rotation=float(rotation[2]))
    # The inverse: 1 / scale * R(-rotation) * (uv - location), which is again such a mapping if the scale is the same on both axes.
    if abs(scale[0] - scale[1]) > 1e-6 * abs(scale[0]) and rotation[2]:
        tree.note("a mapping of a texture by different scales and a rotation; the first scale counts")
        scale = np.full(3, scale[0])
    inverse = [1 / float(s) if s else 0.0 for s in scale[:2]]
    c, s = math.cos(-rotation[2]), math.sin(-rotation[2])
    x, y = -float(location[0]), -float(location[1])
    return replace(place, offset=(inverse[0] * (c * x - s * y), inverse[1] * (s * x + c * y)), scale=tuple(inverse),
                   rotation=-float(rotation[2]))


def _image(tree, node, output):
    problem = values.problem_of_image(node.image)
    if problem:
        tree.note(problem)
        return constant((0.5, 0.5, 0.5, 1.0) if output.type == "RGBA" else 1.0)
    name = node.image.colorspace_settings.name
    if name not in ("sRGB", "Non-Color", "Linear Rec.709", "Raw"):
        tree.note(f"the colour space '{name}' of the image '{node.image.name}' counts as linear Rec. 709")
    texels = tree.texels(node.image)
    place = tree.place(node)
    if output.name == "Alpha":
        return Value(np.ascontiguousarray(texels[..., 3:]), place)
    return Value(texels, place, node.image)


def _math(tree, node, output):
    function = values.MATH.get(node.operation)
    if function is None:
        tree.note(f"the operation {node.operation.lower()} of a Math node; its first value is used")
        return tree.value(node.inputs[0], 1)
    result = tree.combined(function, *(tree.value(socket, 1) for socket in node.inputs if socket.enabled))
    return tree.combined(lambda a: np.clip(a, 0, 1), result) if node.use_clamp else result


def _mix(tree, node, output):
    kind = {"FLOAT": ("Float", 1), "VECTOR": ("Vector", 3), "RGBA": ("Color", 4)}.get(node.data_type)
    if kind is None:
        tree.note("a mix of rotations is left out")
        return constant(0.0)
    name, channels = kind
    factor, a, b = (tree.value(next(s for s in node.inputs if s.identifier == key), count) for key, count in (
        ("Factor_Float", 1), (f"A_{name}", channels), (f"B_{name}", channels)))
    if channels == 3 and node.factor_mode == "NON_UNIFORM":
        factor = tree.value(next(s for s in node.inputs if s.identifier == "Factor_Vector"), 3)
    if node.clamp_factor:
        factor = tree.combined(lambda f: np.clip(f, 0, 1), factor)
    if channels != 4:
        return tree.combined(lambda f, x, y: x + f * (y - x), factor, a, b)
    return _blend(tree, node.blend_type, factor, a, b, node.clamp_result)


def _mix_rgb(tree, node, output):
    factor, a, b = tree.value(node.inputs[0], 1), tree.value(node.inputs[1], 4), tree.value(node.inputs[2], 4)
    return _blend(tree, node.blend_type, tree.combined(lambda f: np.clip(f, 0, 1), factor), a, b, node.use_clamp)


def _blend(tree, kind, factor, a, b, clamp):
    if kind not in values.BLEND:
        tree.note(f"the blend mode {kind.lower()} counts as mix")
        kind = "MIX"
    result = tree.combined(lambda f, x, y: values.blended(kind, f, x, y), factor, a, b)
    return tree.combined(lambda c: np.clip(c, 0, 1), result) if clamp else result


def _invert(tree, node, output):
    return tree.combined(lambda f, c: np.concatenate([c[..., :3] + f * (1 - 2 * c[..., :3]), c[..., 3:]], -1),
                         tree.value(node.inputs[0], 1), tree.value(node.inputs[1], 4))


def _gamma(tree, node, output):
    return tree.combined(lambda c, g: np.concatenate([np.where(c[..., :3] > 0, np.maximum(c[..., :3], 1e-30) ** g, c[..., :3]),
                                                      c[..., 3:]], -1),
                         tree.value(node.inputs[0], 4), tree.value(node.inputs[1], 1))


def _bright_contrast(tree, node, output):
    return tree.combined(lambda c, b, k: np.concatenate([np.maximum((1 + k) * c[..., :3] + b - k / 2, 0), c[..., 3:]], -1),
                         tree.value(node.inputs[0], 4), tree.value(node.inputs[1], 1), tree.value(node.inputs[2], 1))


def _hue_saturation(tree, node, output):
    return tree.combined(values.hue_saturation, *(tree.value(socket, 1) for socket in node.inputs[:4]), tree.value(node.inputs[4], 4))


def _separate(tree, node, output):
    given = tree.value(node.inputs[0], 4)
    if getattr(node, "mode", "RGB") != "RGB":
        tree.note(f"colours that are separated as {node.mode}; they are separated as RGB")
    channel = list(node.outputs).index(output)
    return tree.combined(lambda c: c[..., channel:channel + 1], given)


def _combine(tree, node, output):
    if getattr(node, "mode", "RGB") != "RGB":
        tree.note(f"colours that are combined as {node.mode}; they are combined as RGB")
    parts = [tree.value(socket, 1) for socket in node.inputs[:3]]
    whole = tree.combined(lambda r, g, b: np.concatenate(np.broadcast_arrays(r, g, b), -1), *parts)
    return as_channels(whole, 4) if output.type == "RGBA" else whole


def _ramp(tree, node, output):
    table = np.array([node.color_ramp.evaluate(i / 255) for i in range(256)], np.float32)
    result = tree.combined(lambda f: table[np.clip(np.rint(f[..., 0] * 255), 0, 255).astype(int)], tree.value(node.inputs[0], 1))
    return result if output.type == "RGBA" else tree.combined(lambda c: c[..., 3:], result)


def _map_range(tree, node, output):
    if node.data_type != "FLOAT" or node.interpolation_type != "LINEAR":
        tree.note("a Map Range that is not linear or of vectors counts as linear")
    value, low, high, to_low, to_high = (tree.value(node.inputs[i], 1) for i in range(5))
    result = tree.combined(lambda v, a, b, c, d: np.where(b != a, c + (v - a) / np.where(b == a, 1, b - a) * (d - c), 0),
                           value, low, high, to_low, to_high)
    if not node.clamp:
        return result
    return tree.combined(lambda v, c, d: np.clip(v, np.minimum(c, d), np.maximum(c, d)), result, to_low, to_high)


def _clamp(tree, node, output):
    return tree.combined(lambda v, a, b: np.minimum(np.maximum(v, a), b), *(tree.value(node.inputs[i], 1) for i in range(3)))


def _vector_math(tree, node, output):
    a, b = (as_channels(tree.value(node.inputs[i], 3), 3) for i in range(2))
    functions = {"ADD": np.add, "SUBTRACT": np.subtract, "MULTIPLY": np.multiply, "MINIMUM": np.minimum, "MAXIMUM": np.maximum}
    if node.operation == "SCALE":
        return tree.combined(np.multiply, a, tree.value(node.inputs["Scale"], 1))
    if node.operation not in functions:
        tree.note(f"the operation {node.operation.lower()} of a Vector Math node; its first value is used")
        return a
    return tree.combined(functions[node.operation], a, b)


def _vertex_color(tree, node, output):
    if output.type != "RGBA" or (node.bl_idname == "ShaderNodeAttribute" and node.attribute_type != "GEOMETRY"):
        tree.note(f"the output '{output.name}' of the node '{node.bl_label}' is left out")
        return constant(0.5)
    return VertexColor(node.layer_name if node.bl_idname == "ShaderNodeVertexColor" else node.attribute_name)


def _environment(tree, node, output):
    problem = values.problem_of_image(node.image)
    if problem:
        tree.note(problem)
        return constant((0.0, 0.0, 0.0, 1.0))
    if node.projection != "EQUIRECTANGULAR":
        tree.note("an environment as a mirror ball counts as one in latitude and longitude")
    place = Place(wrap="repeat", filter="trilinear")
    source, _, groups = tree.source(node.inputs["Vector"])
    if source is not None and source.node.bl_idname == "ShaderNodeMapping":
        with tree.within(groups):
            place = replace(_mapping(tree, source.node, Place()), wrap="repeat")
            if any(abs(s - 1) > 1e-6 for s in place.scale) or any(place.offset):
                tree.note("an environment that is moved or scaled is only turned about z")
    elif source is not None and not (source.node.bl_idname == "ShaderNodeTexCoord" and source.name == "Generated"):
        tree.note("the coordinates of the environment are not known; it is not turned")
    return Value(tree.texels(node.image), place, node.image)


_NODES = {
    "ShaderNodeRGB": lambda tree, node, output: tree._default(output),
    "ShaderNodeValue": lambda tree, node, output: tree._default(output),
    "ShaderNodeTexImage": _image,
    "ShaderNodeTexEnvironment": _environment,
    "ShaderNodeMath": _math,
    "ShaderNodeVectorMath": _vector_math,
    "ShaderNodeMix": _mix,
    "ShaderNodeMixRGB": _mix_rgb,
    "ShaderNodeInvert": _invert,
    "ShaderNodeGamma": _gamma,
    "ShaderNodeBrightContrast": _bright_contrast,
    "ShaderNodeHueSaturation": _hue_saturation,
    "ShaderNodeRGBToBW": lambda tree, node, output: tree.value(node.inputs[0], 1),
    "ShaderNodeSeparateColor": _separate,
    "ShaderNodeSeparateXYZ": _separate,
    "ShaderNodeCombineColor": _combine,
    "ShaderNodeCombineXYZ": _combine,
    "ShaderNodeValToRGB": _ramp,
    "ShaderNodeMapRange": _map_range,
    "ShaderNodeClamp": _clamp,
    "ShaderNodeVertexColor": _vertex_color,
    "ShaderNodeAttribute": _vertex_color,
    "ShaderNodeBlackbody": lambda tree, node, output: constant((*values.black_body(tree.number(node, "Temperature")), 1.0)),
}
