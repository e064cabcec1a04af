#!/usr/bin/env python3
"""Pictures of planes and surfaces through a recording: what they show, where they are empty, and what is refused."""

import json
import math
import re
import struct
import zlib

from program import complaint_about_error, run_script, tree
from recording_file import MetaImage

FRAMES = 40
KEYS = {"width", "height", "spacing_mm", "covered"}


def read_png(path):
    """Width, height and the rows of a PNG of 8 bits with alpha, as bytes of four channels."""
    data = path.read_bytes()
    assert data.startswith(b"\x89PNG\r\n\x1a\n")
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        chunk = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", chunk[:10])
            assert (depth, colour) == (8, 6)
        if kind == b"IDAT":
            packed += chunk
        at += 12 + length
    raw, stride = zlib.decompress(packed), 4 * width
    rows, before = [], bytearray(stride)
    for y in range(height):
        kind = raw[y * (stride + 1)]
        row = bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            left, up, corner = (row[i - 4] if i > 3 else 0), before[i], (before[i - 4] if i > 3 else 0)
            if kind == 4:
                guess = left + up - corner
                near = min((abs(guess - left), 0, left), (abs(guess - up), 1, up), (abs(guess - corner), 2, corner))[2]
            row[i] = (row[i] + (0, left, up, (left + up) // 2, near if kind == 4 else 0)[kind]) & 255
        rows.append(row)
        before = row
    return width, height, rows


def grey(rows, channel=0):
    return [list(row[channel::4]) for row in rows]


class Scan:
    """A simulated sweep of a sphere along z, and its own frames as the file has them."""

    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        self.path = folder / "scan.mha"
        program.must_run("simulate", "--object", "sphere", "--pattern", "linear", "--frames", FRAMES, "--out", self.path)
        self.calibration = folder / "scan.calibration.json"
        self.recording = MetaImage(self.path.read_bytes())
        self.width, self.height, _ = map(int, self.recording.get("DimSize").split())

    def frame(self, number):
        size = self.width * self.height
        pixels = self.recording.pixels[number * size:(number + 1) * size]
        return [list(pixels[y * self.width:(y + 1) * self.width]) for y in range(self.height)]

    def arguments(self, *options, out="picture.png"):
        return ["reslice", self.path, "--calibration", self.calibration, "--out", self.folder / out, *options]

    def made(self, *options, out="picture.png"):
        said = self.program.must_run(*self.arguments(*options, "--json", out=out)).json()
        return said, read_png(self.folder / out)


def frames_come_back(scan, tally):
    for number in (0, 17, FRAMES - 1):
        said, (width, height, rows) = scan.made("--through-frame", number)
        tally.check("reslice's keys", sorted(KEYS - set(said)))
        tally.check("the size of the picture", (said["width"], said["height"]) != (width, height) and said)
        tally.check("all is covered", said["covered"] != 1 and said)
        tally.check(f"frame {number} comes back", grey(rows) != scan.frame(number) and "differs")


def fans_are_cut_out(scan, tally):
    x0, y0, least, largest, half_deg = scan.width / 2 + 0.25, -40.25, 60.0, 150.0, 25.0
    said, (width, _, rows) = scan.made("--through-frame", 5, "--fan", f"{x0},{y0},{least},{largest},{-half_deg},{half_deg}")

    def in_fan(x, y):
        angle = math.degrees(math.atan2(x - x0, y - y0))
        return least <= math.hypot(x - x0, y - y0) <= largest and abs(angle) <= half_deg

    wrong = [(x, y) for y, row in enumerate(grey(rows, 3)) for x, alpha in enumerate(row) if (alpha == 255) != in_fan(x, y)]
    tally.check("only the fan is shown", (width != scan.width or not 0 < said["covered"] < 1 or wrong) and f"{said} {wrong[:5]}")


def sphere_from_all_sides(scan, tally):
    """Every plane through the middle of a sphere shows a disc of one size, by any kind of picture."""
    truth = json.loads((scan.folder / "scan.truth.json").read_text())
    radius_mm = 10 * (3 * truth["volume_ml"] / (4 * 3.14159265358979)) ** (1 / 3)
    disc = 3.14159265358979 * radius_mm ** 2
    for options in (["--rotate-deg", 90], ["--rotate-deg", 90, "--mode", "linear"], ["--rotate-deg", 60],
                    ["--rotate-deg", 120, "--mode", "mean", "--thickness-mm", 1],
                    ["--rotate-deg", 90, "--mode", "max", "--thickness-mm", 1]):
        said, (_, _, rows) = scan.made("--through-frame", FRAMES // 2, "--spacing-mm", 0.2, *options)
        area = sum(sum(row) for row in grey(rows)) / 255 * 0.2 ** 2
        tally.check(f"a disc by {options}", abs(area - disc) > 0.03 * disc and f"{area:.1f} of {disc:.1f} mm2")
        alpha = grey(rows, 3)
        shown = sum(a == 255 for row in alpha for a in row) / (said["width"] * said["height"])
        tally.check("holes are transparent", abs(shown - said["covered"]) > 1e-9 and f"{shown} but {said['covered']}")


def other_surfaces(scan, tally):
    plane, _ = scan.made("--through-frame", FRAMES // 2, "--rotate-deg", 90, "--spacing-mm", 0.2)
    origin, x, y = plane["origin_mm"], plane["x_axis"], plane["y_axis"]

    def text(*numbers):
        return ",".join(f"{number:.12g}" for number in numbers)

    size = (plane["width"] * 0.2, plane["height"] * 0.2)
    given, first = scan.made("--origin", text(*origin), "--x-axis", text(*x), "--y-axis", text(*y), "--size-mm",
                             text(*size), "--spacing-mm", 0.2, out="given.png")
    _, through = scan.made("--through-frame", FRAMES // 2, "--rotate-deg", 90, "--spacing-mm", 0.2)
    tally.check("the plane that was told gives the same picture", first != through and given)
    ends = [[o + a * size[0] * share for o, a in zip(origin, x)] for share in (0, 0.4, 1)]
    _, curved = scan.made(*(argument for end in ends for argument in ("--curve", text(*end))), "--y-axis", text(*y),
                          "--height-mm", size[1], "--spacing-mm", 0.2, out="curved.png")
    tally.check("a curve without bends is a plane", curved != first and f"{curved[:2]} and {first[:2]}")
    panorama, (_, height, rows) = scan.made("--panorama", "--spacing-mm", 0.2, out="panorama.png")
    middle = [row[len(row) // 2] for row in grey(rows)]
    tally.check("a panorama shows the sphere", max(middle) != 255 and middle)
    tally.check("a panorama is covered", panorama["covered"] < 0.95 and panorama)


def sweeps_and_planes(program, scan, tally):
    content = scan.path.read_bytes()
    gap = range(18, 24)
    two = scan.folder / "two.mha"
    two.write_bytes(re.sub(rb"(Seq_Frame(\d+)_\w+TransformStatus = )OK", lambda match: match.group(1) + (
        b"INVALID" if int(match.group(2)) in gap else b"OK"), content))
    planes = scan.folder / "planes.json"
    calibration = ("--calibration", scan.calibration)
    program.must_run("planes", two, *calibration, "--out", planes)
    across = ("--through-frame", 10, "--rotate-deg", 90, "--spacing-mm", 0.3, "--json", "--out", scan.folder / "two.png")
    covered = {}
    for name, options in (("both", []), ("first", ["--sweep", 1]), ("second", ["--sweep", 2]), ("planes", ["--planes", planes])):
        said = program.must_run("reslice", two, *calibration, *across, *options).json()
        # The picture of one sweep reaches over that sweep alone: compare what is covered, in pixels.
        covered[name] = said["covered"] * said["width"] * said["height"]
    tally.check("two sweeps show what each shows", abs(covered["first"] + covered["second"] - covered["both"]) > 1 and covered)
    tally.check("planes between sweeps change nothing apart", abs(covered["planes"] - covered["both"]) > 1 and covered)
    # A plane with both sweeps on one side leaves that side to one of them.
    stored = json.loads(planes.read_text())
    stored["dividing_planes"] = [{"normal": [1, 0, 0], "offset_mm": 1e5}]
    beside = scan.folder / "beside.json"
    beside.write_text(json.dumps(stored))
    sides = [program.must_run("reslice", two, *calibration, "--planes", beside, "--through-frame", frame, "--json", "--out",
                              scan.folder / "side.png").json() for frame in (10, 30)]
    hidden = [said for said in sides if said["covered"] == 0]
    tally.check("a sweep is hidden in another's part of space", len(hidden) != 1 and sides)
    tally.check("and a warning says so", "other sweeps' parts" not in str(hidden) and hidden)
    said = program.must_run("reslice", scan.path, *calibration, *across).json()
    whole = said["covered"] * said["width"] * said["height"]
    left = covered["both"] / whole  # without the way from the frame before the gap to the one after
    expected = 1 - (len(gap) + 1) / (FRAMES - 1)
    tally.check("between them is nothing", abs(left - expected) > 0.03 and f"{left} instead of {expected}")
    tally.check("no such sweep", complaint_about_error(program.run("reslice", two, *calibration, *across, "--sweep", 3)))
    return two


def empty_and_refused(program, scan, tally):
    far = ("--origin", "1e5,0,0", "--x-axis", "1,0,0", "--y-axis", "0,1,0", "--size-mm", "4,3", "--spacing-mm", 0.5)
    said, (width, height, rows) = scan.made(*far, out="far.png")
    tally.check("outside of the data nothing is covered", (said["covered"], width, height) != (0, 8, 6) and said)
    tally.check("and a warning says so", "outside" not in " ".join(said["warnings"]) and said)
    tally.check("and the picture is transparent", any(any(row) for row in rows) and "it is not")
    out = scan.folder / "refused"
    out.mkdir()
    plane = ("--origin", "0,0,0", "--x-axis", "1,0,0", "--size-mm", "4,3")
    through = ("--through-frame", 3)
    for name, options in (
            ("axes that are not perpendicular", [*plane, "--y-axis", "1,1,0"]),
            ("an axis without length", [*plane, "--y-axis", "0,0,0"]),
            ("no such frame", ["--through-frame", FRAMES]),
            ("too many pixels", [*through, "--spacing-mm", 1e-6]),
            ("too many layers", [*through, "--thickness-mm", 1e7]),
            ("a side too long for a PNG", [*plane[:-2], "--y-axis", "0,1,0", "--size-mm", "3e6,1", "--spacing-mm", 1]),
            ("a clip outside of the image", [*through, "--clip", "9000,0,5,5"]),
            ("a fan whose radii are in the wrong order", [*through, "--fan", "9,9,50,40,-30,30"]),
            ("planes that are not there", [*through, "--planes", "none.json"]),
            ("not a picture", [*through, "--out", "w.mha"])):
        given = ["reslice", scan.path, "--calibration", scan.calibration, *([] if "--out" in options else ["--out", "w.png"])]
        complaint = complaint_about_error(program.run(*given, *options, cwd=out))
        tally.check(f"refused: {name}", complaint or (tree(out) and f"left behind: {sorted(tree(out))}"))
    for options in ([], [*plane], [*plane, "--y-axis", "0,1"], [*plane, "--y-axis", "0,1,nan"], [*through, "--panorama"],
                    [*through, "--mode", "cubic"], [*through, "--thickness-mm", -1], [*through, "--spacing-mm", 0],
                    [*through, "--size-mm", "0,3"], ["--through-frame", -1], ["--curve", "0,0,0", "--y-axis", "1,0,0"],
                    ["--curve", "0,0", "--curve", "1,1,1", "--y-axis", "1,0,0", "--height-mm", 5],
                    [*through, "--sweep", 1, "--planes", "p.json"], [*through, "--max-gap-mm", 0]):
        outcome = program.run("reslice", scan.path, "--calibration", scan.calibration, "--out", "w.png", *options, cwd=out)
        wrong = outcome.status != 2 or outcome.out or tree(out)
        tally.check(f"wrong command line: {options}", wrong and f"{outcome}")


def body(program, folder, tally, _root):
    scan = Scan(program, folder)
    frames_come_back(scan, tally)
    fans_are_cut_out(scan, tally)
    sphere_from_all_sides(scan, tally)
    other_surfaces(scan, tally)
    sweeps_and_planes(program, scan, tally)
    empty_and_refused(program, scan, tally)


if __name__ == "__main__":
    run_script(__doc__, body)
