#!/usr/bin/env python3
"""Surfaces through drawn contours: methods and meshers, several structures, sweeps that turn back, and what is refused."""

import json
import re

from program import complaint_about_error, run_script, tree
from recording_file import MetaImage
from surfaces import must_refuse, off

FRAMES = 12


def square(frame, x, y, half):
    """A closed contour of a structure on a frame; places in pixels."""
    corners = [[x - half, y - half], [x + half, y - half], [x + half, y + half], [x - half, y + half]]
    return {"frame": frame, "closed": True, "points": corners}


def outline(frame, *points):
    return {"frame": frame, "closed": True, "points": [list(point) for point in points]}


class Scan:
    """A simulated scan of a ball and ways to draw on it."""

    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        self.recording = folder / "scan.mha"
        program.must_run("simulate", "--object", "sphere", "--pattern", "linear", "--frames", FRAMES, "--out", self.recording)
        self.calibration = folder / "scan.calibration.json"
        self.truth_ml = json.loads((folder / "scan.truth.json").read_text())["volume_ml"]
        self.ball = json.loads((folder / "scan.contours.json").read_text())["structures"][0]

    def with_poses(self, name, order):
        """The same pictures, each with the pose of the frame that `order` says."""
        image = MetaImage(self.recording.read_bytes())
        changed = image
        for to, source in enumerate(order):
            for transform in ("ProbeToTracker", "ReferenceToTracker"):
                changed = changed.with_field(f"Seq_Frame{to:04}_{transform}Transform",
                                             image.get(f"Seq_Frame{source:04}_{transform}Transform"))
        (self.folder / name).write_bytes(changed.bytes())
        return self.folder / name

    def arguments(self, structures, recording=None):
        contours = self.folder / "drawn.contours.json"
        contours.write_text(json.dumps({"fathom_contours": 1, "structures": structures}))
        return ["surface", recording or self.recording, "--calibration", self.calibration, "--contours", contours]

    def drawn(self, *contours, recording=None):
        return self.arguments([{"name": "organ", "contours": list(contours)}], recording)

    def make(self, arguments, out, *options):
        return self.program.must_run(*arguments, "--out", out, *options, "--json").json()


def methods(scan, tally):
    out, triangles = scan.folder / "ball.ply", {}
    for method in ("disc", "shape", "centroid"):
        for mesher in ("rmt", "mt", "mc"):
            name = f"{method}, {mesher}"
            made = scan.make(scan.arguments([scan.ball]), out, "--method", method, "--mesher", mesher, "--spacing-mm", 0.7)
            # Twelve frames, linear between them: some per cent are lost at the ends and between.
            tally.check(f"{name}: volume", off(made["volume_ml"], scan.truth_ml, 0.05))
            tally.check(f"{name}: closed", made["closed"] is not True and f"{made}")
            triangles[mesher] = made["triangles"]
        tally.check(f"{method}: rmt has the fewest triangles",
                    not triangles["rmt"] < triangles["mc"] < triangles["mt"] and f"{triangles}")
    default = scan.make(scan.arguments([scan.ball]), out, "--spacing-mm", 0.7)
    same = scan.make(scan.arguments([scan.ball]), scan.folder / "same.ply", "--method", "disc", "--mesher", "rmt",
                     "--spacing-mm", 0.7)
    tally.check("disc and rmt where none is named", default["triangles"] != same["triangles"] or
                out.read_bytes() != (scan.folder / "same.ply").read_bytes())


def several_structures(scan, tally):
    places = {"liver": (110, 20), "left kidney": (190, 30), "a/b": (250, 10)}
    structures = [{"name": name, "contours": [square(i, x, 200, half) for i in range(3, 8)]}
                  for name, (x, half) in places.items()]
    out = scan.folder / "several"
    out.mkdir()
    made = scan.make(scan.arguments(structures), out / "m.ply", "--spacing-mm", 0.3)["structures"]
    expected = ["m.a_b.ply", "m.left kidney.ply", "m.liver.ply"]
    tally.check("a file for each structure", sorted(tree(out)) != expected and f"{sorted(tree(out))}")
    tally.check("and each named", [item["name"] for item in made] != list(places) and f"{made}")
    # Prisms of one height: volumes are as the squares of the sides.
    for item, (_, half) in zip(made, places.values()):
        tally.check(f"the volume of {item['name']}", off(item["volume_ml"] / made[0]["volume_ml"], (half / 20) ** 2, 0.03))
    one = scan.make(scan.arguments(structures), out / "one.ply", "--structure", "left kidney", "--spacing-mm", 0.3)
    tally.check("one of them", one["name"] != "left kidney" or not (out / "one.ply").exists())
    tally.check("one of them, the same mesh", (out / "one.ply").read_bytes() != (out / "m.left kidney.ply").read_bytes())
    must_refuse(scan.program, tally, scan.folder, "a structure that is not there",
                [*scan.arguments(structures), "--structure", "spleen"], "spleen", "liver, left kidney")
    twins = [{"name": name, "contours": structures[0]["contours"]} for name in ("a/b", "a_b")]
    must_refuse(scan.program, tally, scan.folder, "two structures for one file", scan.arguments(twins), "a_b", "--structure")


def turning_back(scan, tally):
    out = scan.folder / "back.ply"
    back = scan.with_poses("back.mha", [0, 1, 2, 3, 4, 5, 6, 5, 4, 3, 2, 1])
    made = scan.make(scan.drawn(*[square(i, 150, 150, 40 + i) for i in range(2, 11)], recording=back), out)
    tally.check("a sweep that comes back whole has no volume", made["volume_ml"] is not None and f"{made}")
    tally.check("and says why", not any("backward" in text for text in made["warnings"]) and f"{made}")
    # There and back and there again over the same squares: what was passed backward counts negative.
    forward = scan.make(scan.drawn(*[square(i, 150, 150, 40) for i in range(2, 8)]), out)["volume_ml"]
    again = scan.with_poses("again.mha", [0, 1, 2, 3, 4, 5, 4, 3, 5, 6, 7, 8])
    made = scan.make(scan.drawn(*[square(i, 150, 150, 40) for i in range(2, 11)], recording=again), out)
    tally.check("a sweep that goes back for a while keeps its volume", off(made["volume_ml"], forward, 0.02))
    tally.check("and says so", not any("backward" in text for text in made["warnings"]) and f"{made}")


def refused(scan, tally):
    def refuse(name, arguments, *parts):
        must_refuse(scan.program, tally, scan.folder, name, arguments, "organ", *parts)

    good = square(4, 150, 150, 40)
    line = ((100, 100), (150, 150), (200, 200))
    refuse("a contour that crosses itself",
           scan.drawn(outline(3, (100, 100), (200, 200), (200, 100), (100, 200)), good), "frame 3", "crosses itself")
    refuse("contours that cross each other", scan.drawn(square(3, 150, 150, 40), square(3, 170, 170, 40), good), "frame 3")
    refuse("contours without area", scan.drawn(outline(3, *line), outline(4, *line)), "area")
    refuse("contours on one frame", scan.drawn(square(4, 100, 150, 20), square(4, 200, 150, 20)), "two frames")
    standing = scan.with_poses("standing.mha", [0, 1, 2, 3, 4, 4, 6, 7, 8, 9, 10, 11])
    refuse("contours on one plane", scan.drawn(*[square(i, 150, 150, 40) for i in (3, 4, 5, 6)], recording=standing),
           "frames 4 and 5", "same plane")
    two = scan.drawn(good, square(5, 150, 150, 40))
    refuse("a spacing too fine", [*two, "--spacing-mm", "0.0001"], "GB", "fits")
    fitting = re.search(r"; ([0-9.]+) mm fits", scan.program.run(*two, "--spacing-mm", "1e-4", "--out", "x.ply",
                                                               cwd=scan.folder).err)
    tally.check("a spacing that fits is a number", not fitting or not 0 < float(fitting.group(1)) < 1)
    empty = scan.folder / "empty"
    empty.mkdir()
    for more in (["--order", "curved", "--method", "centroid"], ["--method", "magic"], ["--mesher", "cubes"],
                 ["--order", "bent"], ["--spacing-mm", "0"], ["--spacing-mm", "nan"]):
        outcome = scan.program.run(*two, *more, "--out", "m.ply", cwd=empty)
        wrong = outcome.status != 2 or outcome.out or not outcome.err
        tally.check(f"surface {' '.join(more)}", wrong and f"{outcome}")
    tally.check("wrong command lines write nothing", sorted(tree(empty)))
    outcome = scan.program.run(*two, "--out", "m.xyz", cwd=empty)
    tally.check("surface --out m.xyz", complaint_about_error(outcome) or sorted(tree(empty)))


def body(program, folder, tally, _root):
    scan = Scan(program, folder)
    for part in (methods, several_structures, turning_back, refused):
        part(scan, tally)


if __name__ == "__main__":
    run_script(__doc__, body)
