#!/usr/bin/env python3
"""Sweeps of a recording, the planes between them, and voxel arrays: what is found, written and refused."""

import json
import re

from program import complaint_about_error, run_script, tree

FRAMES = 30
GAP = range(12, 17)  # frames without a pose, so that two sweeps remain


def scans(program, folder):
    """A scan of one sweep and, from it, one whose poses are lost on the way and one whose poses are lost throughout."""
    whole = folder / "whole.mha"
    program.must_run("simulate", "--object", "sphere", "--pattern", "linear", "--frames", FRAMES, "--out", whole)
    content = whole.read_bytes()

    def lost(frames):
        changed, count = re.subn(
            rb"(Seq_Frame(\d+)_\w+TransformStatus = )OK",
            lambda match: match.group(1) + (b"INVALID" if int(match.group(2)) in frames else b"OK"), content)
        assert count >= FRAMES, "the scan has no statuses to change"
        return changed

    (folder / "two.mha").write_bytes(lost(GAP))
    (folder / "none.mha").write_bytes(lost(range(FRAMES)))
    return whole, folder / "two.mha", folder / "none.mha"


def complaint_about_refusal(program, folder, arguments):
    out = folder / "refused"
    out.mkdir(exist_ok=True)
    return complaint_about_error(program.run(*arguments, cwd=out)) or (tree(out) and f"left behind: {sorted(tree(out))}")


def sweeps_and_planes(program, folder, tally):
    whole, two, none = scans(program, folder)
    calibration = ("--calibration", folder / "whole.calibration.json")
    found = json.loads(program.must_run("sweeps", two, "--json").out)["sweeps"]
    expected = [(0, GAP.start - 1), (GAP.stop, FRAMES - 1)]
    tally.check("lost poses end a sweep", [(s["first"], s["last"]) for s in found] != expected and found)
    alone = json.loads(program.must_run("sweeps", whole, "--json").out)["sweeps"]
    tally.check("one sweep stays one", [(s["first"], s["last"]) for s in alone] != [(0, FRAMES - 1)] and alone)

    turning = folder / "turning.mha"  # a fan of a few degrees between frames, and three fans in a row
    for pattern, frames, starts in (("fan", 36, [0]), ("sweeps-f", 36, [0, 12, 24])):
        program.must_run("simulate", "--object", "sphere", "--pattern", pattern, "--frames", frames, "--out", turning)
        for way in ((), ("--calibration", folder / "turning.calibration.json")):
            found = json.loads(program.must_run("sweeps", turning, *way, "--json").out)["sweeps"]
            tally.check(f"sweeps of {pattern}, {'with' if way else 'without'} a calibration",
                        [s["first"] for s in found] != starts and found)

    planes = json.loads(program.must_run("planes", two, *calibration, "--json", "--out", folder / "planes.json").out)
    tally.check("two sweeps side by side need one plane", len(planes["dividing_planes"]) != 1 and planes)
    tally.check("each sweep has its side", sorted(cell["sweep"] for cell in planes["cells"]) != [0, 1] and planes)
    length = sum(component ** 2 for component in planes["dividing_planes"][0]["normal"])
    tally.check("the normal has length 1", abs(length - 1) > 1e-9 and planes)
    stored = json.loads((folder / "planes.json").read_text())
    tally.check("the file holds the same planes", stored["dividing_planes"] != planes["dividing_planes"] and stored)
    added = json.loads(program.must_run("planes", two, *calibration, "--json", "--add", "0,0,2,10").out)
    tally.check("a normal of length 2: z = 5", added["dividing_planes"][-1] != {"normal": [0, 0, 1], "offset_mm": 5} and added)
    none_needed = json.loads(program.must_run("planes", whole, *calibration, "--json").out)
    tally.check("one sweep needs no plane", none_needed["dividing_planes"] != [] and none_needed)

    many = [argument for offset in range(40) for argument in ("--add", f"1,0,0,{offset}")]
    for name, arguments in (
            ("all frames invalid", ["planes", none, *calibration]),
            ("a normal without length", ["planes", whole, *calibration, "--add", "0,0,0,0"]),
            ("more than 32 planes", ["planes", whole, *calibration, *many]),
            ("no such recording", ["sweeps", folder / "absent.mha"])):
        tally.check(f"refused: {name}", complaint_about_refusal(program, folder, arguments))
    for name, added in (("three numbers", "1,0,0"), ("a word", "1,0,x,0"), ("not finite", "nan,0,0,1")):
        outcome = program.run("planes", whole, *calibration, "--add", added, cwd=folder)
        tally.check(f"wrong command line: {name}", outcome.status not in (1, 2) and f"{outcome}")


def voxel_arrays(program, folder, tally):
    whole, none = folder / "whole.mha", folder / "none.mha"
    calibration = ("--calibration", folder / "whole.calibration.json")
    for name in ("v.mha", "v.nrrd"):
        made = json.loads(program.must_run("reconstruct", whole, *calibration, "--spacing-mm", 0.5, "--fill-holes", "--out",
                                           folder / name, "--json").out)
        keys = {"dimensions", "spacing_mm", "origin_mm", "filled", "seconds"}
        tally.check(f"keys of {name}", sorted(keys - set(made)))
        # The voxels lie where the surface of the scan does: the ball's volume comes back from the array.
        truth = json.loads((folder / "whole.truth.json").read_text())["volume_ml"]
        mesh = json.loads(program.must_run("isosurface", folder / name, "--value", 128, "--out", folder / "v.ply", "--json").out)
        wrong = mesh["volume_ml"] is None or abs(mesh["volume_ml"] - truth) > 0.05 * truth
        tally.check(f"a ball's volume from {name}", wrong and f"{mesh['volume_ml']} of {truth} ml")
    for name, arguments in (
            ("all frames invalid", ["reconstruct", none, *calibration, "--spacing-mm", 0.5, "--out", "w.mha"]),
            ("too fine for memory", ["reconstruct", whole, *calibration, "--spacing-mm", 0.001, "--out", "w.mha"]),
            ("a picture", ["reconstruct", whole, *calibration, "--spacing-mm", 0.5, "--out", "w.png"])):
        tally.check(f"refused: {name}", complaint_about_refusal(program, folder, arguments))
    for spacing in ("0", "-1", "nan", "x"):
        outcome = program.run("reconstruct", whole, *calibration, "--spacing-mm", spacing, "--out", "w.mha", cwd=folder)
        tally.check(f"wrong command line: spacing {spacing}", outcome.status != 2 and f"{outcome}")


def orders(program, folder, tally):
    whole = folder / "whole.mha"
    drawn = ["surface", whole, "--calibration", folder / "whole.calibration.json", "--contours", folder / "whole.contours.json"]
    truth = json.loads((folder / "whole.truth.json").read_text())["volume_ml"]
    measured = json.loads(program.must_run("measure", *drawn[1:], "--json").out)["structures"][0]["volume_ml"]
    error = {}
    for order, key in (("linear", "disc_guided"), ("curved", "disc_guided_curved")):
        made = json.loads(program.must_run(*drawn, "--order", order, "--out", folder / f"{order}.ply", "--json").out)
        error[order] = abs(made["volume_ml"] - truth) / truth
        tally.check(f"measure and surface agree: {order}", made["volume_ml"] != measured[key] and f"{made} {measured}")
    program.must_run(*drawn, "--out", folder / "default.ply")
    same = (folder / "default.ply").read_bytes() == (folder / "curved.ply").read_bytes()
    tally.check("curved where no order is named", not same and "it differs")
    tally.check("the curved order loses less of a ball", error["curved"] >= error["linear"] and f"{error}")


def body(program, folder, tally, _root):
    for part in (sweeps_and_planes, voxel_arrays, orders):
        part(program, folder, tally)


if __name__ == "__main__":
    run_script(__doc__, body)
