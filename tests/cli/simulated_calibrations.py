#!/usr/bin/env python3
"""Calibrations from simulated images of wires, a floor and a bead: right, or refused with a clear message, never wrong."""

import json
import re

from calibrations import distance, refused
from program import run_script
from recording_file import MetaImage

FRAMES = 100  # four seconds
WIDTH, HEIGHT = 640, 480


def scan(program, folder, name, *options):
    out = folder / f"{name}.mha"
    program.must_run("simulate", "--frames", FRAMES, "--seed", 3, "--out", out, *options)
    return out


def images(image):
    size = WIDTH * HEIGHT
    return [image.pixels[at:at + size] for at in range(0, len(image.pixels), size)]


def rows(picture):
    return [picture[at:at + WIDTH] for at in range(0, len(picture), WIDTH)]


def with_images(path, change, size=None):
    image = MetaImage(path.read_bytes())
    changed = image.with_pixels(b"".join(b"".join(change(rows(one))) for one in images(image)))
    return changed.with_field("DimSize", f"{size[0]} {size[1]} {FRAMES}") if size else changed


def with_header(path, change):
    image = MetaImage(path.read_bytes())
    image.fields = [(key, change(key, value)) for key, value in image.fields]
    return image


def frame_of(key):
    match = re.match(r"Seq_Frame(\d+)_Probe", key)
    return int(match.group(1)) if match else None


def in_metres(key, value):
    if frame_of(key) is None or not key.endswith("Transform"):
        return value
    numbers = [float(number) for number in value.split()]
    return " ".join(str(0.001 * number if at in (3, 7, 11) else number) for at, number in enumerate(numbers))


def first_three(path):
    image = MetaImage(path.read_bytes()).with_field("DimSize", f"{WIDTH} {HEIGHT} 3")
    image.fields = [(key, value) for key, value in image.fields
                    if not (match := re.match(r"Seq_Frame(\d+)_", key)) or int(match.group(1)) < 3]
    return image.with_pixels(image.pixels[:3 * WIDTH * HEIGHT])


def three_ns():
    """The wires of PLUS's recordings: they look different from behind and upside down."""
    def n(z, left, right, front, back):
        ends = [((left, 0, z), (left, 40, z)), ((front, 0, z), (back, 40, z)), ((right, 0, z), (right, 40, z))]
        return {"wires": [{"name": f"{z}{k}", "front": list(a), "back": list(b)} for k, (a, b) in enumerate(ends)]}
    return {"fathom_phantom": 1, "name": "three", "patterns": [n(20, 30, 60, 55, 35), n(10, 30, 60, 35, 55), n(0, 35, 60, 55, 40)]}


def place(matrix, x, y):
    return [sum(a * b for a, b in zip(matrix[4 * row:4 * row + 4], (x, y, 0, 1))) for row in range(3)]


def farthest(found, truth, seen_at=lambda x, y: (x, y)):
    """Between two calibrations, over the image's corners; the first is of images in which (x, y) moved to seen_at."""
    corners = [(x, y) for x in (0, WIDTH - 1) for y in (0, HEIGHT - 1)]
    return max(distance(place(found, *seen_at(*corner)), place(truth, *corner)) for corner in corners)


def body(program, folder, tally, _root):
    phantom, other = folder / "phantom.json", folder / "other.json"
    phantom.write_text(json.dumps(three_ns() | {"phantom_to_reference":
                                                            [1, 0, 0, 9, 0, 1, 0, 8, 0, 0, 1, 7, 0, 0, 0, 1]}))
    unlike = three_ns()
    for wire in unlike["patterns"][1]["wires"]:  # 4 mm higher than in the phantom that is scanned
        wire.update({end: [wire[end][0], wire[end][1], wire[end][2] + 4] for end in ("front", "back")})
    other.write_text(json.dumps(unlike))

    wires = scan(program, folder, "wires", "--object", "wires", "--phantom", phantom, "--pattern", "calibrate",
                 "--noise-mm", "0.1", "--noise-deg", "0.06")
    wall = scan(program, folder, "wall", "--object", "wall", "--pattern", "calibrate", "--probe", "curvilinear")
    point = scan(program, folder, "point", "--object", "point", "--pattern", "calibrate")
    targets = {"wires": (wires, phantom), "wall": (wall, "wall"), "point": (point, "point")}
    truth = {}
    for name, (recording, target) in targets.items():
        truth[name] = json.loads((folder / f"{name}.truth.json").read_text())["calibration"]["image_to_probe"]
        found = program.must_run("calibrate", "spatial", recording, "--phantom", target, "--out", folder / "c.json",
                                 "--json").json()
        tally.check(f"{name}: the truth", farthest(found["image_to_probe"], truth[name]) > 1.0 and found)

    mirrored = folder / "mirrored.mha"
    mirrored.write_bytes(with_images(wires, lambda lines: [line[::-1] for line in lines]).bytes())
    found = program.must_run("calibrate", "spatial", mirrored, "--phantom", phantom, "--out", folder / "c.json",
                             "--json").json()
    tally.check("mirrored images of wires: a calibration of these images", farthest(
        found["image_to_probe"], truth["wires"], lambda x, y: (WIDTH - 1 - x, y)) > 1.0 and found)

    upside_down = with_images(wires, lambda lines: lines[::-1])
    turned = with_images(wires, lambda lines: [bytes(column) for column in zip(*lines[::-1])], (HEIGHT, WIDTH))
    lost = with_header(wires, lambda key, value: "INVALID" if key.endswith("TransformStatus") and frame_of(key) is not None
                       and frame_of(key) % 50 < 25 else value)
    bad = [("upside down", upside_down, phantom, "upside down"), ("turned", turned, phantom, "right angle"),
           ("another phantom", MetaImage(wires.read_bytes()), other, ""),
           ("no wires in view", MetaImage(point.read_bytes()), phantom, "are not seen"),
           ("no floor in view", MetaImage(point.read_bytes()), "wall", "shows a wall"),
           ("tracker lost for half", lost, phantom, "the tracker saw the probe in only"),
           ("three frames", first_three(wires), phantom, "3 frames only"),
           ("poses in metres", with_header(wires, in_metres), phantom, "in metres")]
    for name, image, target, words in bad:
        recording = folder / "bad.mha"
        recording.write_bytes(image.bytes())
        tally.check(f"refused: {name}", refused(program, folder, [
            "calibrate", "spatial", recording, "--phantom", target, "--out", "cal.json"], words))

    still = scan(program, folder, "still", "--object", "wires", "--phantom", phantom, "--pattern", "still")
    tally.check("refused: a probe that never moved", refused(program, folder, [
        "calibrate", "spatial", still, "--phantom", phantom, "--out", "cal.json"], "did not move"))
    tally.check("simulate refused: nothing in view", refused(program, folder, [
        "simulate", "--object", "point", "--pattern", "calibrate", "--away-mm", "300", "--frames", "5", "--out", "s.mha"],
        "none of the 5 frames shows the whole point"))
    for words in ("--object wires --pattern calibrate", "--object point --pattern linear",
                  f"--object wall --pattern calibrate --phantom {phantom}", "--object sphere --pattern floor",
                  "--object sphere --pattern linear --probe curvilinear", "--object wall --pattern floor --jitter-mm 1",
                  "--object point --pattern still --outliers 2"):
        outcome = program.run("simulate", *words.split(), "--frames", "5", "--out", "s.mha", cwd=folder)
        tally.check(f"wrong command line: simulate {words}", outcome.status != 2 and f"{outcome}")


if __name__ == "__main__":
    run_script(__doc__, body)
