#!/usr/bin/env python3
"""Outlining by seeds and from drawn contours, on images that show nothing, from seeds and contours that are wrong."""

import copy
import json
import math
import re

from damaged_documents import broken_json
from program import complaint_about_error, run_script, tree
from recording_file import MetaImage

WIDTH, HEIGHT, FRAMES = 640, 480, 9
MIDDLE = 4  # the frame in the middle of the scan
SQUARE = [[260, 180], [380, 180], [380, 300], [260, 300]]


def seeds_text(*outlines):
    return json.dumps({"fathom_seeds": 1, "outlines": list(outlines)})


def contours_text(**structures):
    return json.dumps({"fathom_contours": 1, "structures": [
        {"name": name, "contours": contours} for name, contours in structures.items()]})


def outline(frame, points, **others):
    return {"frame": frame, "points": points, **others}


def ring(middle, radius, count=24):
    return [[middle[0] + radius * math.cos(2 * math.pi * i / count), middle[1] + radius * math.sin(2 * math.pi * i / count)]
            for i in range(count)]


def area_px(points):
    pairs = zip(points, points[1:] + points[:1])
    return abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in pairs)) / 2


def middle_of(points):
    return [sum(point[axis] for point in points) / len(points) for axis in (0, 1)]


class Scan:
    """A scan of a bladder and the prostate below, the same with other images, and files beside them."""

    def __init__(self, program, folder):
        self.program, self.folder, self.count = program, folder, 0
        self.recording = folder / "scan.mha"
        program.must_run("simulate", "--object", "bladder-prostate", "--pattern", "linear", "--frames", FRAMES, "--speckle",
                         "--out", self.recording)
        self.image = MetaImage(self.recording.read_bytes())
        self.calibration = ("--calibration", folder / "scan.calibration.json")
        self.truth = json.loads((folder / "scan.contours.json").read_text())["structures"]

    def outlines(self, structure, frame=MIDDLE):
        return [c["points"] for c in self.truth[structure]["contours"] if c["frame"] == frame and "points" in c]

    def file(self, name, content):
        path = self.folder / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    def with_images(self, name, change):
        """The scan with other pixels: change(frame's bytes) gives new ones."""
        size = WIDTH * HEIGHT
        frames = [change(self.image.pixels[i * size: (i + 1) * size]) for i in range(FRAMES)]
        return self.file(name, self.image.with_pixels(b"".join(frames)).bytes())

    def with_fields(self, name, fields):
        changed = self.image
        for key, value in fields.items():
            changed = changed.with_field(key, value)
        return self.file(name, changed.bytes())

    def refused(self, tally, name, arguments, *words):
        """One line of an error that holds these words, and nothing left where the results would be."""
        out = self.folder / f"refused{self.count}"
        self.count += 1
        out.mkdir()
        outcome = self.program.run(*arguments, "--out", "c.json", "--picture", "p.png", cwd=out)
        missing = [word for word in words if not re.search(word, outcome.err)]
        tally.check(f"refused: {name}", complaint_about_error(outcome) or (tree(out) and f"left behind: {sorted(tree(out))}")
                    or (missing and f"the message does not say {missing}: {outcome.err}"))

    def made(self, arguments):
        """The structures that are written by what has to succeed, each a list of points by frame."""
        out = self.folder / "made.json"
        self.program.must_run(*arguments, "--out", out)
        return {s["name"]: s["contours"] for s in json.loads(out.read_text())["structures"]}


def flat_images(scan, tally):
    """Nothing is to be seen: tools that look for something say so; the live-wire goes straight from seed to seed."""
    seeds = scan.file("square.seeds.json", seeds_text(outline(MIDDLE, SQUARE)))
    inside = ["--seed", f"{MIDDLE},320,240"]
    for name, grey in (("empty", 0), ("saturated", 255), ("grey", 90)):
        flat = scan.with_images(f"{name}.mha", lambda pixels, grey=grey: bytes([grey]) * len(pixels))
        drawn = scan.file("square.json", contours_text(organ=[outline(3, SQUARE), outline(6, SQUARE)]))
        scan.refused(tally, f"a region in {name} images", ["segment", flat, "--method", "region", *inside], "no border")
        wire = scan.made(["segment", flat, "--method", "live-wire", "--seeds", seeds])["object"]
        tally.check(f"live-wire in {name} images: straight", abs(area_px(wire[0]["points"]) - 120 * 120) > 1 and f"{wire}")
        refined = scan.made(["segment", flat, "--method", "refine", "--contours", drawn])["organ"]
        moved = [area_px(c["points"]) for c in refined]
        tally.check(f"refinement in {name} images: stays", any(abs(a - 120 * 120) > 1 for a in moved) and f"{moved}")
        filled = scan.made(["propagate", flat, "--contours", drawn])["organ"]
        between = {c["frame"]: area_px(c["points"]) for c in filled if "confidence" in c}
        tally.check(f"propagation in {name} images: as drawn",
                    (set(between) != {4, 5} or any(abs(a - 120 * 120) > 100 for a in between.values())) and f"{between}")
        for threshold, contours in ((128, 1 if grey >= 128 else 0), (300, 0)):
            found = scan.made(["segment", flat, "--threshold", threshold, "--every", 3])["object"]
            wrong = len(found) != 3 * contours or any(abs(area_px(c["points"]) - WIDTH * HEIGHT) > 1 for c in found)
            tally.check(f"threshold {threshold} in {name} images: all or nothing", wrong and f"{len(found)} contours")


def wrong_seeds(scan, tally):
    """Seeds outside of the image, where there is no image, and files of seeds that are damaged."""
    for method in ("live-wire", "region"):
        segment = ["segment", scan.recording, "--method", method]
        for name, place in (("left", "-1,240"), ("right", "640,240"), ("above", "320,-0.6"), ("below", "320,479.6"),
                            ("far", "320,1e9")):
            scan.refused(tally, f"{method}, a seed {name} of the image",
                         [*segment, "--seed", f"{MIDDLE},320,240", "--seed", f"{MIDDLE},{place}"], f"frame {MIDDLE}", "640 x 480")
        scan.refused(tally, f"{method}, a seed on a frame behind the last", [*segment, "--seed", f"{FRAMES},320,240"],
                     f"frame {FRAMES}", "0 to 8")
        hidden = scan.with_fields("hidden.mha", {f"Seq_Frame{MIDDLE:04}_ImageStatus": "INVALID"})
        scan.refused(tally, f"{method}, a seed on an image that is marked as invalid",
                     ["segment", hidden, "--method", method, "--seed", f"{MIDDLE},320,240"], f"frame {MIDDLE}", "invalid")
        good = seeds_text(outline(MIDDLE, SQUARE))
        other = seeds_text({**outline(MIDDLE, SQUARE), "recording": 1})
        scan.refused(tally, f"{method}, seeds of another recording",
                     [*segment, "--seeds", scan.file("s.json", other)], "recording 1")
        first = 0 if method == "region" else 1  # the file is read the same way for both
        for name, content in list(damaged_seeds(good))[first::2]:
            scan.refused(tally, f"{method}, seeds: {name}", [*segment, "--seeds", scan.file("s.json", content)])
        for typed in ("4,320", "4,320,240,1", "4.5,320,240", "-1,320,240", "4,x,240", "4,nan,240", "4,inf,240", ""):
            outcome = scan.program.run(*segment, "--seed", typed, "--out", "x.json", cwd=scan.folder)
            wrong = outcome.status != 2 or (scan.folder / "x.json").exists()
            tally.check(f"wrong command line: {method} --seed {typed!r}", wrong and f"{outcome}")
        outcome = scan.program.run(*segment, "--out", "x.json", cwd=scan.folder)
        tally.check(f"wrong command line: {method} without seeds", outcome.status != 2 and f"{outcome}")


def damaged_seeds(good):
    yield from ((name, content) for name, content in broken_json(good.encode()) if len(content) < 1_000_000)
    document = json.loads(good)

    def with_entry(**changes):
        entry = {**document["outlines"][0], **changes}
        return seeds_text({key: value for key, value in entry.items() if value is not None})

    yield "another kind of file", contours_text(organ=[outline(MIDDLE, SQUARE)])
    yield "of a version to come", json.dumps({**document, "fathom_seeds": 2})
    yield "none", seeds_text()
    yield "no points", with_entry(points=[])
    yield "no frame", with_entry(frame=None)
    yield "a negative frame", with_entry(frame=-1)
    yield "a frame that is a text", with_entry(frame="4")
    yield "a point of three numbers", with_entry(points=[[1, 2, 3], *SQUARE])
    yield "a point of texts", with_entry(points=[["1", "2"], *SQUARE])
    yield "a point that is null", with_entry(points=[None, *SQUARE])
    yield "NaN", with_entry(points=[[float("nan"), 2], *SQUARE])
    yield "too many points", with_entry(points=[[i % 600, i % 400] for i in range(10_001)])


def few_seeds(scan, tally):
    """Outlines of very few seeds, and seeds that enclose nothing or cross."""
    wire = ["segment", scan.recording, "--method", "live-wire", "--seeds"]
    for name, points, words in (
            ("one seed", SQUARE[:1], "two seeds"),
            ("the same place twice", [SQUARE[0], SQUARE[0], SQUARE[1]], "where the one before is"),
            ("a double click", [SQUARE[0], [260.2, 180.2], SQUARE[1]], "where the one before is")):
        scan.refused(tally, f"live-wire, {name}", [*wire, scan.file("s.json", seeds_text(outline(MIDDLE, points)))],
                     f"frame {MIDDLE}", words)
    twice = scan.file("s.json", seeds_text(outline(MIDDLE, SQUARE), outline(MIDDLE, [[x + 60, y + 60] for x, y in SQUARE])))
    scan.refused(tally, "live-wire, two outlines that cross", [*wire, twice], f"frame {MIDDLE}", "cross")
    truth = scan.outlines(0)[0]
    three = [truth[round(i * len(truth) / 3)] for i in range(3)]
    made = scan.made([*wire, scan.file("s.json", seeds_text(outline(MIDDLE, three)))])["object"]
    ratio = area_px(made[0]["points"]) / area_px(truth)
    tally.check("live-wire from three seeds", not 0.8 < ratio < 1.2 and f"{ratio} of the area")


def wrong_regions(scan, tally):
    segment = ["segment", scan.recording, "--method", "region"]
    inside = ["--seed", f"{MIDDLE},{','.join(map(str, middle_of(scan.outlines(0)[0])))}"]
    scan.refused(tally, "a range without the seed's values", [*segment, *inside, "--low", 250, "--high", 255], "range", "frame 4")
    scan.refused(tally, "a range that is upside down", [*segment, *inside, "--low", 90, "--high", 20], "upside down")
    black = scan.with_images("sector.mha", lambda pixels: b"".join(
        bytes(100) + pixels[y * WIDTH + 100: (y + 1) * WIDTH] for y in range(HEIGHT)))  # beside what the probe sees
    beside = scan.made(["segment", black, "--method", "region", "--seed", f"{MIDDLE},50,240"])["object"]
    areas = [area_px(c["points"]) for c in beside]
    tally.check("a region beside what the probe sees stays there",
                (len(areas) != 1 or abs(areas[0] - 100 * HEIGHT) > 2 * HEIGHT) and f"{areas}")
    scan.refused(tally, "a range of everything", [*segment, *inside, "--low", 0, "--high", 255], "no border")


def contours_of_few_points(scan, tally):
    """Triangles are outlines; fewer points, no area and lines that cross are none."""
    triangle = [[260, 180], [380, 180], [320, 300]]
    drawn = scan.file("d.json", contours_text(organ=[outline(3, triangle), outline(6, triangle)]))
    refined = scan.made(["segment", scan.recording, "--method", "refine", "--contours", drawn])["organ"]
    areas = [area_px(c["points"]) for c in refined]
    tally.check("triangles are refined", len(areas) != 2 or any(not 0.5 < a / 7200 < 1.5 for a in areas) and f"{areas}")
    filled = scan.made(["propagate", scan.recording, *scan.calibration, "--contours", drawn])["organ"]
    tally.check("triangles are propagated", {c["frame"] for c in filled} != {3, 4, 5, 6} and f"{filled}")
    broken = [(name, content) for name, content in broken_json(contours_text().encode()) if len(content) < 1_000_000]
    for first, command in enumerate((["segment", scan.recording, "--method", "refine"],
                                     ["propagate", scan.recording, *scan.calibration])):
        for name, content in [*broken[first::2], *wrong_contours(triangle)]:
            scan.refused(tally, f"{command[0]}: {name}", [*command, "--contours", scan.file("d.json", content)])


def wrong_contours(triangle):
    def pair(points):
        return contours_text(organ=[outline(3, points), outline(6, triangle)])

    yield "another kind of file", seeds_text(outline(3, triangle))
    yield "no structures", contours_text()
    yield "two points", pair(triangle[:2])
    yield "no points", pair([])
    yield "three points on a line", pair([[260, 180], [320, 180], [380, 180]])
    yield "three times the same point", pair([[260, 180]] * 3)
    yield "an outline that crosses itself", pair([[260, 180], [380, 300], [380, 180], [260, 300]])
    yield "an outline drawn twice", contours_text(organ=[outline(3, triangle)] * 2 + [outline(6, triangle)])
    yield "a frame behind the last", contours_text(organ=[outline(3, triangle), outline(FRAMES, triangle)])
    yield "another recording's outline", contours_text(organ=[outline(3, triangle), outline(6, triangle, recording=1)])
    yield "NaN", pair([[float("nan"), 1], *triangle])


def gaps(scan, tally):
    """Nothing is carried over to another sweep; the message says why. Within a sweep all goes on as before."""
    truth = scan.truth[0]
    def drawn(*frames):
        contours = [c for c in truth["contours"] if c["frame"] in frames and "points" in c]
        return scan.file("d.json", contours_text(bladder=contours))

    lost = {f"Seq_Frame{frame:04}_{of}TransformStatus": "INVALID" for frame in (4,) for of in ("ProbeToTracker",)}
    late = {f"Seq_Frame{frame:04}_Timestamp": f"{3.52 + 0.04 * frame + 60}" for frame in range(5, FRAMES)}
    jump = {}
    for frame in range(5, FRAMES):
        key = f"Seq_Frame{frame:04}_ProbeToTrackerTransform"
        numbers = scan.image.get(key).split()
        numbers[3] = str(float(numbers[3]) + 80)
        jump[key] = " ".join(numbers)
    whole = scan.made(["propagate", scan.recording, *scan.calibration, "--contours", drawn(2, 3, 5, 7)])["bladder"]
    tally.check("one sweep is filled", {c["frame"] for c in whole} != set(range(2, 8)) and f"{[c['frame'] for c in whole]}")
    for name, fields in (("a jump of the probe", jump), ("a minute's break", late)):
        gap = scan.with_fields("gap.mha", fields)
        for way, options in (("with", scan.calibration), ("without", ())):
            scan.refused(tally, f"propagation across {name}, {way} a calibration",
                         ["propagate", gap, *options, "--contours", drawn(3, 6)], "frames 3 to 6", "sweep")
            out = scan.folder / "partly.json"
            said = scan.program.must_run("propagate", gap, *options, "--contours", drawn(1, 3, 5, 7), "--out", out, "--json").json()
            frames = {c["frame"] for c in json.loads(out.read_text())["structures"][0]["contours"]}
            tally.check(f"what is beside {name} is filled, {way} a calibration",
                        (frames != {1, 2, 3, 5, 6, 7} or not any("3 to 5" in why for why in said["refused"])) and f"{said}")
    hidden = scan.with_fields("lost.mha", lost)
    made = scan.made(["propagate", hidden, *scan.calibration, "--contours", drawn(3, 6)])["bladder"]
    tally.check("a frame without a pose is left out", {c["frame"] for c in made} != {3, 5, 6} and f"{[c['frame'] for c in made]}")


def touching(scan, tally):
    """Structures side by side stay side by side; two outlines of one structure do not grow into each other."""
    middle = [320, 240]
    half = [[middle[0] - 80, 160], [middle[0], 160], [middle[0], 320], [middle[0] - 80, 320]]
    other = [[2 * middle[0] - x, y] for x, y in reversed(half)]
    frames = (2, 6)
    drawn = scan.file("d.json", contours_text(left=[outline(f, half) for f in frames], right=[outline(f, other) for f in frames]))
    made = scan.made(["propagate", scan.recording, *scan.calibration, "--contours", drawn])
    for frame in (3, 4, 5):
        lefts = [p for c in made["left"] if c["frame"] == frame for p in c["points"]]
        rights = [p for c in made["right"] if c["frame"] == frame for p in c["points"]]
        tally.check(f"propagated structures that touch, frame {frame}", overlap_px(lefts, rights))
    refined = scan.made(["segment", scan.recording, "--method", "refine", "--contours", drawn])
    for frame in frames:
        lefts, rights = ([p for c in refined[name] if c["frame"] == frame for p in c["points"]] for name in ("left", "right"))
        tally.check(f"refined structures that touch, frame {frame}", overlap_px(lefts, rights))


def overlap_px(lefts, rights):
    """What is wrong with two outlines that should lie side by side: how many points of one lie deep in the other."""
    if not lefts or not rights:
        return "one is missing"
    deep = [p for p in lefts if inside(p, rights)] + [p for p in rights if inside(p, lefts)]
    far = max((min(math.dist(p, q) for q in (rights if p in lefts else lefts)) for p in deep), default=0)
    return far > 1.0 and f"{far} pixels deep"


def inside(point, polygon):
    odd = False
    for (ax, ay), (bx, by) in zip(polygon, polygon[1:] + polygon[:1]):
        if (ay > point[1]) != (by > point[1]) and point[0] < ax + (point[1] - ay) / (by - ay) * (bx - ax):
            odd = not odd
    return odd


def body(program, folder, tally, _root):
    scan = Scan(program, folder)
    for part in (flat_images, wrong_seeds, few_seeds, wrong_regions, contours_of_few_points, gaps, touching):
        part(scan, tally)


if __name__ == "__main__":
    run_script(__doc__, body)
