#!/usr/bin/env python3
"""Surfaces over several sweeps: what `surface --planes` makes of a ball, says and refuses."""

import json
import re

from program import complaint_about_error, run_script, tree

FRAMES = 40
SPLIT = 20  # the first frame of the second sweep
LOST = range(18, 22)  # frames whose poses are taken away to have the planes placed


def scan(program, folder):
    """A ball in one linear sweep, and a planes file that takes it for two."""
    whole = folder / "ball.mha"
    program.must_run("simulate", "--object", "sphere", "--pattern", "linear", "--frames", FRAMES, "--out", whole)
    content = re.sub(rb"(Seq_Frame(\d+)_\w+TransformStatus = )OK",
                     lambda match: match.group(1) + (b"INVALID" if int(match.group(2)) in LOST else b"OK"),
                     whole.read_bytes())
    (folder / "two.mha").write_bytes(content)
    program.must_run("planes", folder / "two.mha", "--calibration", folder / "ball.calibration.json", "--out",
                     folder / "placed.json")
    planes = json.loads((folder / "placed.json").read_text())
    planes["sweeps"] = [{"recording": 0, "first": 0, "last": SPLIT - 1},
                        {"recording": 0, "first": SPLIT, "last": FRAMES - 1}]
    (folder / "planes.json").write_text(json.dumps(planes))
    return planes


def overlapping_sweeps(program, folder, tally):
    """Three sweeps that overlap and look in different directions, from the scan to its volumes."""
    scanned = folder / "three.mha"
    program.must_run("simulate", "--object", "ellipsoid", "--pattern", "sweeps-e", "--frames", 60, "--out", scanned)
    truth = json.loads((folder / "three.truth.json").read_text())["volume_ml"]
    calibration = ("--calibration", folder / "three.calibration.json")
    found = json.loads(program.must_run("sweeps", scanned, *calibration, "--json").out)["sweeps"]
    tally.check("the three sweeps are found",
                [(s["first"], s["last"]) for s in found] != [(0, 19), (20, 39), (40, 59)] and found)
    program.must_run("planes", scanned, *calibration, "--out", folder / "three.planes.json")
    drawn = [scanned, *calibration, "--contours", folder / "three.contours.json", "--planes", folder / "three.planes.json"]
    structure = json.loads(program.must_run("measure", *drawn, "--json").out)["structures"][0]
    for method in ("linear_planimetry", "cubic_planimetry"):
        volume = structure["volume_ml"][method]
        tally.check(f"{method} of three sweeps gives the ellipsoid",
                    (volume is None or abs(volume - truth) > 0.02 * truth) and f"{volume}, not {truth}")
    made = json.loads(program.must_run("surface", *drawn, "--out", folder / "three.ply", "--json").out)
    tally.check("a surface for each of three sweeps",
                sorted({part["sweep"] for part in made["partitions"]}) != [0, 1, 2] and made)
    tally.check("and together they hold the ellipsoid",
                (made["volume_ml"] is None or abs(made["volume_ml"] - truth) > 0.05 * truth)
                and f"{made['volume_ml']}, not {truth}: {made['warnings']}")


def body(program, folder, tally, _root):
    overlapping_sweeps(program, folder, tally)
    planes = scan(program, folder)
    truth = json.loads((folder / "ball.truth.json").read_text())["volume_ml"]
    drawn = ["surface", folder / "ball.mha", "--calibration", folder / "ball.calibration.json", "--contours",
             folder / "ball.contours.json"]

    def made(planes_file, *more, out="parts.ply"):
        return json.loads(program.must_run(*drawn, "--planes", planes_file, "--out", folder / out, "--json", *more).out)

    parts = made(folder / "planes.json")
    tally.check("a part for each sweep", [part["sweep"] for part in parts["partitions"]] not in ([0, 1], [1, 0]) and parts)
    tally.check("the parts are closed", not parts["closed"] and parts)
    total = sum(part["volume_ml"] for part in parts["partitions"])
    tally.check("the volume is the sum of the parts", abs(total - parts["volume_ml"]) > 1e-9 and parts)
    tally.check("triangles add up",
                sum(part["triangles"] for part in parts["partitions"]) != parts["triangles"] and parts)
    # Neither sweep reaches the plane: what lies between the frames beside it is lost, which must be said.
    missing = [float(found.group(1)) for text in parts["warnings"]
               if (found := re.search(r"short of dividing plane 1: about ([\d.e-]+) ml missing", text))]
    tally.check("both ends are said to be short", len(missing) != 2 and parts["warnings"])
    wrong = abs(parts["volume_ml"] + sum(missing) - truth) > 0.01 * truth
    tally.check("with what is said to be missing it is the ball", wrong and f"{parts['volume_ml']} + {missing}, not {truth}")

    # Planes through a sweep: one plane that cuts every frame, the same sweep on both sides.
    normal = planes["dividing_planes"][0]["normal"]
    across = [normal[1], normal[2], normal[0]]
    one = {"fathom_planes": 1, "sweeps": [{"first": 0, "last": FRAMES - 1}],
           "dividing_planes": [{"normal": across, "offset_mm": 0.0}]}
    (folder / "one.json").write_text(json.dumps(one))
    alone = made(folder / "one.json", out="one.ply")
    plain = json.loads(program.must_run(*drawn, "--out", folder / "plain.ply", "--json").out)
    tally.check("planes do not divide a single sweep",
                (len(alone["partitions"]) != 1 or alone["volume_ml"] != plain["volume_ml"]) and alone)
    tally.check("without planes there are no parts", "partitions" in plain and plain)
    tally.check("and the mesh is the same", (folder / "one.ply").read_bytes() != (folder / "plain.ply").read_bytes() and "differs")

    # A second plane across both sweeps: nothing is lost at it, and the wall is left out when asked for.
    two = dict(planes, dividing_planes=[{"normal": normal, "offset_mm": planes["dividing_planes"][0]["offset_mm"] + 3.0}])
    (folder / "shifted.json").write_text(json.dumps(two))
    closed = made(folder / "shifted.json")
    left_open = made(folder / "shifted.json", "--open", out="open.ply")
    tally.check("a plane through one sweep cuts it", not closed["cuts"] and closed)
    tally.check("what only one side has is said", not any("do not meet" in text for text in closed["warnings"]) and closed)
    tally.check("open parts are open", left_open["closed"] and left_open)
    same = all(abs(a["volume_ml"] - b["volume_ml"]) < 1e-9
               for a, b in zip(closed["partitions"], left_open["partitions"]))
    tally.check("faces in the planes are no surface of the structure",
                abs(closed["area_cm2"] - left_open["area_cm2"]) > 1e-9 and f"{closed['area_cm2']}, not {left_open['area_cm2']}")
    tally.check("and have the same volumes", not same and f"{closed} {left_open}")
    shown = program.must_run(*drawn, "--planes", folder / "planes.json", "--out", folder / "shown.ply").out
    tally.check("people see the parts", not re.search(r"sweep +planes", shown) and shown)

    beyond = dict(planes, sweeps=[{"first": 0, "last": SPLIT - 1}, {"first": SPLIT, "last": FRAMES}])
    (folder / "beyond.json").write_text(json.dumps(beyond))
    other = dict(planes, sweeps=[{"recording": 1, "first": 0, "last": SPLIT - 1}])
    (folder / "other.json").write_text(json.dumps(other))
    (folder / "none.json").write_text(json.dumps(dict(planes, dividing_planes=[])))
    (folder / "damaged.json").write_text("{")
    out = folder / "refused"
    out.mkdir()
    for name in ("beyond", "other", "none", "damaged", "absent"):
        outcome = program.run(*drawn, "--planes", folder / f"{name}.json", "--out", "w.ply", cwd=out)
        tally.check(f"refused: {name}", complaint_about_error(outcome) or (tree(out) and f"left behind: {sorted(tree(out))}"))
    outcome = program.run(*drawn, "--open", "--out", "w.ply", cwd=out)
    tally.check("wrong command line: open without planes", outcome.status != 2 and f"{outcome}")


if __name__ == "__main__":
    run_script(__doc__, body)
