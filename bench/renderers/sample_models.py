"""Renders Khronos' sample models of glTF with claray, beside their screenshots, and counts samples that are not finite.

    pip install pillow
    python3 bench/renderers/sample_models.py build/bin/claray FOLDER MODELS

MODELS: the folder `Models` of glTF-Sample-Assets (or glTF-Sample-Models/2.0). Each model's variants are all loaded and rendered:
the first with --spp samples, the others with 4. Variants that lack files are named. Writes FOLDER/MODEL.png, sheets of pairs
(claray left, screenshot right) as FOLDER/sheet-N.png, and FOLDER/models.csv. Prints a row for each model.
"""
import argparse
import csv
import json
import os
import re
import subprocess
import urllib.parse

from PIL import Image, ImageDraw

SIDE, PAIRS_OF_A_SHEET, PAIRS_OF_A_ROW = 160, 30, 5


def variants(model):
    """The files of glTF of a model, the plain one first."""
    found = []
    for folder in sorted(os.listdir(model), key=lambda name: (name != "glTF", name)):
        if folder.startswith("glTF") and os.path.isdir(os.path.join(model, folder)):
            found += [os.path.join(model, folder, name) for name in sorted(os.listdir(os.path.join(model, folder)))
                      if name.endswith((".gltf", ".glb"))]
    return found


def missing_files(path):
    if path.endswith(".glb"):
        return []
    with open(path, encoding="utf-8") as file:
        gltf = json.load(file)
    uris = [part["uri"] for part in gltf.get("buffers", []) + gltf.get("images", []) if "uri" in part]
    names = [urllib.parse.unquote(uri) for uri in uris if not uri.startswith("data:")]
    return [name for name in names if not os.path.exists(os.path.join(os.path.dirname(path), name))]


def render(claray, path, image, spp):
    done = subprocess.run([claray, "render", path, "-o", image, "--size", f"{SIDE}x{SIDE}", "--spp", str(spp)],
                          capture_output=True, text=True)
    lines = done.stderr.splitlines()
    dropped = re.search(r"([0-9]+) samples were not finite", done.stderr)
    told = [line.split(": ", 2)[-1] for line in lines if ": warning: " in line or ": error: " in line]
    return done.returncode, int(dropped.group(1)) if dropped else 0, told


def screenshot(model):
    folder = os.path.join(model, "screenshot")
    names = sorted(os.listdir(folder), key=lambda name: (not name.startswith("screenshot."), name)) if os.path.isdir(folder) else []
    return os.path.join(folder, names[0]) if names else None


def pair(image, shot, name):
    sheet = Image.new("RGB", (2 * SIDE, SIDE + 14), "white")
    for i, path in enumerate((image, shot)):
        if path and os.path.exists(path):
            with Image.open(path) as picture:
                picture = picture.convert("RGB")
                picture.thumbnail((SIDE, SIDE))
                sheet.paste(picture, (i * SIDE, 0))
    ImageDraw.Draw(sheet).text((2, SIDE + 1), name, "black")
    return sheet


def write_sheets(pairs, folder):
    for number, first in enumerate(range(0, len(pairs), PAIRS_OF_A_SHEET)):
        part = pairs[first:first + PAIRS_OF_A_SHEET]
        rows = -(-len(part) // PAIRS_OF_A_ROW)
        sheet = Image.new("RGB", (PAIRS_OF_A_ROW * 2 * SIDE, rows * (SIDE + 14)), "white")
        for i, each in enumerate(part):
            sheet.paste(each, (i % PAIRS_OF_A_ROW * 2 * SIDE, i // PAIRS_OF_A_ROW * (SIDE + 14)))
        sheet.save(os.path.join(folder, f"sheet-{number}.png"))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("claray")
    parser.add_argument("folder")
    parser.add_argument("models")
    parser.add_argument("--spp", type=int, default=256)
    parser.add_argument("--only", nargs="*", help="names of models")
    options = parser.parse_args()
    os.makedirs(options.folder, exist_ok=True)
    rows, pairs = [], []
    for name in sorted(os.listdir(options.models)):
        model = os.path.join(options.models, name)
        if not os.path.isdir(model) or (options.only and name not in options.only):
            continue
        image, shown = os.path.join(options.folder, name + ".png"), False
        for path in variants(model):
            row = {"model": name, "variant": os.path.basename(os.path.dirname(path)), "status": "", "dropped": 0, "told": ""}
            gone = missing_files(path)
            if gone:
                row["status"], row["told"] = "lacks files", gone[0]
            else:
                output = os.path.join(options.folder, "other.png") if shown else image
                code, row["dropped"], told = render(options.claray, path, output, 4 if shown else options.spp)
                row["status"], row["told"] = "rendered" if code == 0 else f"exit {code}", " | ".join(told)
                shown = shown or code == 0
            rows.append(row)
            print(f"{name:34} {row['variant']:22} {row['status']:12} {row['dropped']:8} {row['told'][:200]}", flush=True)
        pairs.append(pair(image if shown else None, screenshot(model), name))
    with open(os.path.join(options.folder, "models.csv"), "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)
    write_sheets(pairs, options.folder)
    print(f"{len(pairs)} models, {sum(row['status'] == 'rendered' for row in rows)} of {len(rows)} variants rendered, "
          f"{sum(row['dropped'] for row in rows)} samples not finite")


if __name__ == "__main__":
    main()
