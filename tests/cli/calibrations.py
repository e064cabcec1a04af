#!/usr/bin/env python3
"""Calibrations: of the image on the probe, a pointer's tip, the tracker's latency, landmarks touched with a pointer."""

import json

import tracked_recordings as tracked
from program import complaint_about_error, run_script, tree


def refused(program, folder, arguments, words=""):
    out = folder / "refused"
    out.mkdir(exist_ok=True)
    outcome = program.run(*arguments, cwd=out)
    return (complaint_about_error(outcome) or (tree(out) and f"left behind: {sorted(tree(out))}")
            or (words not in outcome.err and f"does not say {words!r}: {outcome.err}"))


def without(keys, document):
    return sorted(set(keys) - set(document))


def distance(a, b):
    return sum((x - y) ** 2 for x, y in zip(a, b)) ** 0.5


def pivot(program, folder, tally):
    good, plain, still = folder / "pivot.mha", folder / "plain.mha", folder / "still.mha"
    good.write_bytes(tracked.pivoting())
    plain.write_bytes(tracked.pivoting(tilt=(0.5, 0.0)))
    still.write_bytes(tracked.pivoting(tilt=(0.0, 0.0)))
    found = program.must_run("calibrate", "pivot", good, "--tool", "Stylus", "--json").json()
    tally.check("pivot: keys", without({"tip_mm", "stddev_mm", "pivot_mm", "rms_mm", "max_mm", "tilt_deg", "poses_used",
                                        "poses_valid", "verdict"}, found))
    tally.check("pivot: the tip", distance(found["tip_mm"], tracked.TIP) > 0.15 and found)
    tally.check("pivot: rms of 0.2 mm on three axes", abs(found["rms_mm"] - 0.346) > 0.04 and found)
    tally.check("pivot: verdict", not found["verdict"].startswith("good") and found)
    said = program.must_run("calibrate", "pivot", good).out
    tally.check("pivot: for people", [w for w in ("tip of Stylus", "standard deviation", "verdict: good") if w not in said])
    for name, recording, words in (("one axis", plain, "one axis only"), ("still", still, "hardly turned")):
        tally.check(f"pivot refused: {name}", refused(program, folder, ["calibrate", "pivot", recording], words))
    tally.check("pivot refused: no such tool", refused(program, folder, ["calibrate", "pivot", good, "--tool", "Needle"]))


def temporal(program, folder, tally):
    latency = 0.073
    names = ("images", "poses", "together")
    for name, content in zip(names, tracked.over_floor(latency)):
        (folder / f"{name}.mha").write_bytes(content)
    images, poses, together = (folder / f"{name}.mha" for name in names)
    command = ["calibrate", "temporal", "--image"]
    for name, recordings in (("separate", [images, "--tracker", poses]), ("together", [together])):
        out = folder / f"{name}.json"
        found = program.must_run(*command, *recordings, "--out", out, "--json").json()
        tally.check(f"temporal, {name}: keys", without({"latency_s", "stddev_s", "correlation", "verdict"}, found))
        tally.check(f"temporal, {name}: latency", abs(found["latency_s"] - latency) > 0.002 and found)
        tally.check(f"temporal, {name}: a small deviation", not 0 < found["stddev_s"] < 0.002 and found)
        stored = json.loads(out.read_text())
        tally.check(f"temporal, {name}: the file says the same", stored["latency_s"] != found["latency_s"] and stored)
    said = program.must_run(*command, together).out
    tally.check("temporal: for people", [w for w in ("late by 7", "correlation 0.99", "verdict: good") if w not in said])

    calibration = folder / "calibration.json"
    calibration.write_text(json.dumps({"fathom_calibration": 1, "latency_s": 0.5, "probe": "P1", "image_to_probe": [
        0.2, 0, 0, -10, 0, 0.2, 0, 5, 0, 0, 0.2, 3, 0, 0, 0, 1]}))
    out = folder / "with.json"
    program.must_run(*command, together, "--calibration", calibration, "--out", out)
    stored = json.loads(out.read_text())
    kept = stored["probe"] == "P1" and stored["image_to_probe"][3] == -10
    tally.check("temporal: the calibration with this latency", (not kept or abs(stored["latency_s"] - latency) > 0.002) and stored)

    unlike, still = folder / "unlike.mha", folder / "no_motion.mha"
    unlike.write_bytes(tracked.over_floor(0.0, motion=lambda t: tracked.hand(1.37 * t + 40))[0])
    still.write_bytes(tracked.over_floor(0.0, motion=lambda t: 0.0)[0])
    for name, recordings, words in (
            ("another motion", [unlike, "--tracker", poses], "does not follow"),
            ("floor at rest", [still, "--tracker", poses], "does not move"),
            ("images without poses", [images], ""), ("poses without images", [poses], ""),
            ("no such file", [folder / "absent.mha"], ""),
            ("a damaged calibration", [together, "--calibration", images], "")):
        tally.check(f"temporal refused: {name}", refused(program, folder, [*command, *recordings, "--out", "c.json"], words))


def csv(path, rows):
    path.write_text("".join(",".join(map(str, row)) + "\n" for row in rows))
    return path


def landmarks(program, folder, tally):
    names = list(tracked.LANDMARKS)
    shuffled = [names[i] for i in (3, 0, 4, 2, 1)]
    nameless = csv(folder / "nameless.csv", [tracked.LANDMARKS[n] for n in names])
    named = csv(folder / "named.csv", [("name", "x", "y", "z"), *((n, *tracked.LANDMARKS[n]) for n in names)])
    to = csv(folder / "to.csv", tracked.moved_landmarks(shuffled))
    to_named = csv(folder / "to_named.csv", [(n, *place) for n, place in zip(shuffled, tracked.moved_landmarks(shuffled))][1:])
    expected = [shuffled.index(name) for name in names]
    register = ["register", "landmarks", "--from"]
    found = program.must_run(*register, nameless, "--to", to, "--json").json()
    tally.check("landmarks: keys", without({"transform", "rms_mm", "order", "pairs", "verdict"}, found))
    tally.check("landmarks: order found", found["order"] != expected and found)
    tally.check("landmarks: exact", found["rms_mm"] > 1e-6 and found)
    by_name = program.must_run(*register, named, "--to", to_named, "--json").json()
    tally.check("landmarks: by their names, one missing",
                by_name["order"] != [None if i == 0 else i - 1 for i in expected] and by_name)
    tally.check("landmarks refused: in order, which they are not",
                refused(program, folder, [*register, nameless, "--to", to, "--in-order"], "do not fit"))

    touched = folder / "touched.mha"
    touched.write_bytes(tracked.pointing(shuffled))
    pointer = ["--to-recording", touched, "--tip", ",".join(map(str, tracked.TIP))]
    found = program.must_run(*register, named, *pointer, "--json").json()
    tally.check("landmarks touched: order", found["order"] != expected and found)
    tally.check("landmarks touched: rms", found["rms_mm"] > 0.3 and found)
    truth = tracked.moved_landmarks(names)
    transform = [found["transform"][4 * row:4 * row + 4] for row in range(3)]
    placed = [[sum(a * b for a, b in zip(row, (*tracked.LANDMARKS[n], 1))) for row in transform] for n in names]
    tally.check("landmarks touched: places", max(map(distance, placed, truth)) > 0.3 and placed)
    said = program.must_run(*register, named, *pointer).out
    tally.check("landmarks: for people", [w for w in ("left ear", "transform:", "verdict: good") if w not in said])

    hesitant = folder / "hesitant.mha"
    hesitant.write_bytes(tracked.pointing(["nose", "left ear", "in the air", "right ear", "brow"]))
    found = program.must_run(*register, named, "--to-recording", hesitant, *pointer[2:], "--json").json()
    tally.check("landmarks touched: one missed, one rest in the air", found["order"] != [0, 1, 3, None, 4] and found)

    square = csv(folder / "square.csv", [(0, 0, 0), (50, 0, 0), (50, 50, 0), (0, 50, 0)])
    line = csv(folder / "line.csv", [(0, 0, 0), (10, 10, 0), (30, 30, 0)])
    tally.check("landmarks refused: symmetric", refused(program, folder, [*register, square, "--to", square], "symmetric"))
    tally.check("landmarks refused: on a line", refused(program, folder, [*register, line, "--to", line], "on a line"))
    tally.check("landmarks: a square in order",
                program.run(*register, square, "--to", square, "--in-order").status != 0 and "refused")
    for words in ("", f"--to {to} --to-recording {touched}", f"--to-recording {touched}", f"--to {to} --tip 1,2,3",
                  f"--to-recording {touched} --tip 1,2", f"--to-recording {touched} --tip 1,2,x"):
        outcome = program.run(*register, named, *words.split(), cwd=folder)
        tally.check(f"wrong command line: {words}", outcome.status != 2 and f"{outcome}")


SPATIAL_KEYS = {"image_to_probe", "latency_s", "rms_mm", "validation_mean_mm", "validation_mean_all_mm", "validation_rms_mm",
                "validation_max_mm", "validation_wire_mean_mm", "parameters", "stddev", "frames_used", "verdict"}


def spatial(program, folder, tally):
    scan, out, picture = folder / "bead.mha", folder / "bead.json", folder / "bead.png"
    scan.write_bytes(tracked.over_point())
    command = ["calibrate", "spatial", scan, "--phantom", "point", "--out", out]
    found = program.must_run(*command, "--validate", scan, "--picture", picture, "--json").json()
    tally.check("spatial: keys", without(SPATIAL_KEYS, found))
    first = [found["image_to_probe"][4 * row + 3] for row in range(3)]
    last = [sum(a * b for a, b in zip(found["image_to_probe"][4 * row:4 * row + 4], (127, 127, 0, 1))) for row in range(3)]
    far = tracked.turned(tracked.IMAGE_TURN, [127 * mm for mm in tracked.PIXEL_MM] + [0])
    tally.check("spatial: the first pixel", distance(first, tracked.IMAGE_PLACE) > 0.1 and found)
    tally.check("spatial: the last pixel",
                distance(last, [a + b for a, b in zip(tracked.IMAGE_PLACE, far)]) > 0.1 and found)
    tally.check("spatial: a deviation a parameter", len(found["stddev"]) != len(found["parameters"]) and found)
    tally.check("spatial: verdict", found["verdict"] != "good" and found)
    stored = json.loads(out.read_text())
    tally.check("spatial: the file says the same", stored["image_to_probe"] != found["image_to_probe"] and stored)
    tally.check("spatial: the file's covariance", len(stored["covariance"]) != len(stored["parameters"]) and stored)
    tally.check("spatial: a picture", picture.read_bytes()[:4] != b"\x89PNG" and "no PNG")
    said = program.must_run(*command).out
    tally.check("spatial: for people", [w for w in ("width of a pixel", "verdict: good") if w not in said])
    cold = program.must_run(*command, "--water-temperature-c", "20", "--json").json()
    sizes = [sum(result["image_to_probe"][4 * row + 1] ** 2 for row in range(3)) ** 0.5 for result in (found, cold)]
    tally.check("spatial: depth in water at 20 degrees", abs(sizes[1] / sizes[0] - 1540 / 1482.38) > 2e-3 and sizes)

    phantom, small = folder / "phantom.json", folder / "metres.json"
    phantom.write_text(json.dumps(tracked.wire_phantom()))
    in_metres = tracked.wire_phantom()
    for pattern in in_metres["patterns"]:
        for wire in pattern["wires"]:
            wire.update({end: [0.001 * value for value in wire[end]] for end in ("front", "back")})
    small.write_text(json.dumps(in_metres))
    for name, content, target, words in (
            ("three frames", tracked.over_point(count=3), "point", "in 3 frames only"),
            ("a probe at rest", tracked.over_point(moving=False), "point", "did not move"),
            ("lost for half of the sweep", tracked.over_point(lost=range(20, 50)), "point", "only 30 of the 60 frames"),
            ("no pose at all", tracked.over_point(lost=range(60)), "point", "no valid pose"),
            ("poses in metres", tracked.over_point(scale=0.001), "point", "in metres"),
            ("nothing in view", tracked.over_point(visible=False), "point", "none of its 60 frames shows"),
            ("no floor in view", tracked.over_point(), "wall", "shows a wall"),
            ("no wires in view", tracked.over_point(), phantom, "are not seen"),
            ("a phantom in metres", tracked.over_point(), small, "metres")):
        recording = folder / "bad.mha"
        recording.write_bytes(content)
        tally.check(f"spatial refused: {name}", refused(program, folder, [
            "calibrate", "spatial", recording, "--phantom", target, "--out", "cal.json", "--picture", "cal.png"], words))
    for words in ("", "--out x.json", "--phantom point", "--phantom point --out x.json --picture x.jpg",
                  "--phantom point --out x.json --water-temperature-c 101", "--phantom point --out x.json --face-row 3"):
        outcome = program.run("calibrate", "spatial", scan, *words.split(), cwd=folder)
        tally.check(f"wrong command line: spatial {words}", outcome.status != 2 and f"{outcome}")


def body(program, folder, tally, _root):
    for part in (pivot, temporal, landmarks, spatial):
        part(program, folder, tally)


if __name__ == "__main__":
    run_script(__doc__, body)
