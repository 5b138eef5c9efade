"""Renders Mitsuba 3 scene files with claray and with Mitsuba itself, and compares the means of the pictures.

    pip install mitsuba numpy pillow
    python3 bench/renderers/scene_files.py build/bin/claray FOLDER SCENE.xml...

Both read the same file: a copy beside the scene, with a path tracer of depth --depth (Mitsuba's `volpath`, because its `path` is biased where masks
shade lamps), a film of about --pixels, a constant light of radiance 1 in place of skies that are computed, grey in place of missing images, and without
the shapes whose meshes are missing. Writes FOLDER/means.csv, pairs as FOLDER/NAME.png, and FOLDER/sheet.png with all pairs. Prints a row a scene: the
ratio of the means of the three channels, and the noise of the ratio. Mitsuba's LLVM variant needs DRJIT_LIBLLVM_PATH.
"""
import argparse
import csv
import os
import subprocess
import time
import xml.etree.ElementTree as ET

import mitsuba as mi
import numpy as np
from PIL import Image, ImageDraw

from scenes import read_pfm


def child(node, tag, **attributes):
    return ET.SubElement(node, tag, attributes)


def new_object(parent, tag, kind):
    for old in parent.findall(tag):
        parent.remove(old)
    return child(parent, tag, type=kind)


TAGS = ("default include alias path scene shape bsdf texture emitter sensor sampler film rfilter integrator medium phase volume ref float integer "
        "boolean string rgb spectrum blackbody vector point transform matrix translate scale rotate lookat lookAt").split()


def drop_unknown(node):
    """Elements of other renderers that read the format."""
    for each in list(node):
        node.remove(each) if each.tag not in TAGS else drop_unknown(each)


def load(path, variant):
    """As mi.load_file does, but properties that are not read are no errors."""
    config = mi.parser.ParserConfig(variant)
    config.unused_parameters = config.unused_properties = mi.LogLevel.Debug
    mi.file_resolver().prepend(os.path.dirname(os.path.abspath(path)))
    state = mi.parser.parse_file(config, path)
    mi.parser.transform_all(config, state)
    return mi.parser.instantiate(config, state)


def size_of(root, sensor, pixels):
    defaults = {d.get("name"): d.get("value") for d in root.findall("default")}
    film = sensor.find("film")

    def side(name, otherwise):
        for each in film if film is not None else []:
            if each.get("name") == name:
                value = each.get("value")
                return float(defaults[value[1:]] if value.startswith("$") else value)
        return otherwise
    aspect = side("width", 768) / side("height", 576)
    height = max(8, round((pixels / aspect) ** 0.5))
    return max(8, round(height * aspect)), height


def prepared(path, pixels, depth):
    """Writes the copy that both read. Returns its path, the size, and how many shapes are left out."""
    tree = ET.parse(path)
    root, folder = tree.getroot(), os.path.dirname(path)
    sensor = root.find("sensor")
    width, height = size_of(root, sensor, pixels)
    new_object(root, "integrator", "volpath").append(ET.Element("integer", name="max_depth", value=str(depth)))
    new_object(sensor, "sampler", "independent")
    film = new_object(sensor, "film", "hdrfilm")
    for name, value in (("width", width), ("height", height)):
        child(film, "integer", name=name, value=str(value))
    child(film, "rfilter", type="box")
    drop_unknown(root)
    for sky in root.findall("emitter"):
        if sky.get("type") in ("sunsky", "sky", "sun"):  # which claray does not have
            root.remove(sky)
            child(child(root, "emitter", type="constant"), "rgb", name="radiance", value="1")
    for owner in list(root.iter()):
        if owner.get("value") == "trilinear":  # of Mitsuba 0.5
            owner.set("value", "bilinear")
        for texture in owner.findall("texture"):
            if any(s.get("name") == "filename" and not os.path.exists(os.path.join(folder, s.get("value"))) for s in texture):
                owner.remove(texture)
                if texture.get("name"):
                    child(owner, "rgb", name=texture.get("name"), value="0.5")
    left_out = 0
    for shape in root.findall("shape"):
        names = [s.get("value") for s in shape.findall("string") if s.get("name") == "filename"]
        if any(not os.path.exists(os.path.join(folder, name)) for name in names):
            root.remove(shape)
            left_out += 1
    copy = os.path.join(folder, "compared.xml")
    tree.write(copy)
    return copy, (width, height), left_out


def by_claray(claray, path, size, spp, depth, folder, seed):
    image = os.path.join(folder, "claray.pfm")
    command = [claray, "render", path, "-o", image, "--size", "%dx%d" % size, "--spp", str(spp), "--max-depth", str(depth - 1),
               "--seed", str(seed), "--quiet"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return read_pfm(image)


def picture(image, exposure):
    return Image.fromarray((255 * np.clip(image * exposure, 0, 1) ** (1 / 2.2)).astype(np.uint8))


def pair(name, ours, theirs):
    exposure = 0.35 / max(np.median(theirs.mean(2)), 0.2 * theirs.mean(), 1e-9)
    h, w = theirs.shape[:2]
    both = Image.new("RGB", (2 * w + 2, h + 12), "white")
    both.paste(picture(ours, exposure), (0, 12)), both.paste(picture(theirs, exposure), (w + 2, 12))
    ImageDraw.Draw(both).text((2, 0), name, fill="black")
    return both


def sheet_of(pairs, columns=4):
    w, h = max(p.width for p in pairs), max(p.height for p in pairs)
    sheet = Image.new("RGB", (columns * (w + 4), -(-len(pairs) // columns) * (h + 4)), "white")
    for i, each in enumerate(pairs):
        sheet.paste(each, (i % columns * (w + 4), i // columns * (h + 4)))
    return sheet


def compare(options, name, path):
    copy, size, left_out = prepared(path, options.pixels, options.depth)
    start = time.time()
    ours = [by_claray(options.claray, copy, size, options.spp, options.depth, options.folder, seed) for seed in (1, 2)]
    between = time.time()
    scene = load(copy, options.variant)
    theirs = [np.array(mi.render(scene, seed=seed, spp=options.spp))[:, :, :3] for seed in (1, 2)]
    a, b = [i.mean((0, 1)) for i in ours], [i.mean((0, 1)) for i in theirs]
    ratio = np.mean(a, 0) / np.maximum(np.mean(b, 0), 1e-12)
    noise = 0.5 * np.hypot(np.subtract(*a) / np.mean(a, 0), np.subtract(*b) / np.mean(b, 0)).max()
    both = pair(name, np.mean(ours, 0), np.mean(theirs, 0))
    both.save(os.path.join(options.folder, name + ".png"))
    row = [name, *("%.4f" % r for r in ratio), "%.4f" % noise, left_out, "%.0f" % (between - start), "%.0f" % (time.time() - between)]
    print("%-28s ratio %s  noise %.4f  left out %d%s" % (name, np.array2string(ratio, precision=4), noise, left_out,
                                                       "" if np.abs(ratio - 1).max() <= 0.01 else "  TOO FAR"), flush=True)
    return row, both


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("claray")
    parser.add_argument("folder")
    parser.add_argument("scenes", nargs="+", help="NAME=FILE or FILE, whose folder is its name")
    parser.add_argument("--spp", type=int, default=256)
    parser.add_argument("--depth", type=int, default=17, help="Mitsuba's max_depth")
    parser.add_argument("--pixels", type=int, default=14400)
    parser.add_argument("--variant", default="llvm_ad_rgb")
    options = parser.parse_args()
    mi.set_variant(options.variant)
    os.makedirs(options.folder, exist_ok=True)
    rows, pairs = [], []
    for scene in options.scenes:
        name, path = scene.split("=", 1) if "=" in scene else (os.path.basename(os.path.dirname(scene)), scene)
        try:
            row, both = compare(options, name, path)
        except Exception as error:  # the other scenes are compared all the same
            print("%-28s %s" % (name, str(error).splitlines()[0][:200]), flush=True)
            continue
        rows.append(row), pairs.append(both)
        with open(os.path.join(options.folder, "means.csv"), "w", newline="") as file:
            csv.writer(file).writerows([["scene", "red", "green", "blue", "noise", "left out", "s claray", "s Mitsuba"], *rows])
        sheet_of(pairs).save(os.path.join(options.folder, "sheet.png"))


if __name__ == "__main__":
    main()
