"""The simulated scans and exams that scenarios of the viewer work on, and what they do to them."""

import json
import subprocess

from viewer_driver import IDLE, at


def fathom(program, *arguments):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


class Shared:
    """A simulated scan and exams of it; scenarios copy what they change."""

    def __init__(self, program, folder):
        self.program = program
        self.scan = folder / "scan.mha"
        self.calibration = folder / "scan.calibration.json"
        fathom(program, "simulate", "--object", "ellipsoid", "--pattern", "linear", "--frames", 12, "--out", self.scan)
        self.truth = json.loads((folder / "scan.contours.json").read_text())["structures"][0]
        self.outlines = {c["frame"]: c["points"] for c in self.truth["contours"] if "points" in c}
        self.frames = sorted(self.outlines)
        self.thin = folder / "thin.json"  # so that points are far enough apart to be taken by the mouse
        self.thin.write_text(json.dumps({"fathom_contours": 1, "structures": [
            {"name": "bladder", "color": "#33ccff",
             "contours": [{"frame": f, "closed": True, "points": self.loop(f, 16)} for f in self.frames[1:8]]}]}))
        self.pair = folder / "pair.mha"
        fathom(program, "simulate", "--object", "ellipsoid", "--pattern", "sweeps-b", "--frames", 16, "--out", self.pair)
        pair = json.loads((folder / "pair.contours.json").read_text())
        for contour in pair["structures"][0]["contours"]:
            if "points" in contour:
                contour["points"] = contour["points"][::8]
        (folder / "pair.json").write_text(json.dumps(pair))
        self.timed = folder / "timed.mha"  # long enough to be recorded
        fathom(program, "simulate", "--object", "ellipsoid", "--pattern", "linear", "--frames", 100, "--out", self.timed)
        self.pair_calibration = folder / "pair.calibration.json"
        self.pair_contours = folder / "pair.json"

    def loop(self, frame, count):
        points = self.outlines[frame]
        return [points[i * len(points) // count] for i in range(count)]

    def exam(self, folder):
        path = folder / "exam"
        fathom(self.program, "exam", "create", path, "--recording", self.scan, "--calibration", self.calibration,
               "--contours", self.thin)
        return path

    def measured_ml(self, folder, contours_text):
        """What `fathom measure` says of outlines."""
        contours = folder / "to_measure.json"
        contours.write_text(contours_text)
        out = json.loads(fathom(self.program, "measure", self.scan, "--calibration", self.calibration, "--contours",
                                contours, "--json"))
        return out["structures"][0]["volume_ml"]["cubic_planimetry"]


def draw(points):
    return {"drag": [at(*p) for p in points + points[:1]]}


def go_to(frame):
    return [{"click": {"item": "pane:Timeline", "at": [(frame + 0.5) / 12, 0.7]}}, IDLE]


def drawing(shared, frames, count=40):
    events = [IDLE, {"click": "Draw"}]
    for frame in frames:
        events += go_to(frame) + [draw(shared.loop(frame, count))]
    return events


def recording(shared):
    return [shared.scan, "--calibration", shared.calibration]


def structure(state, index=0):
    return state["document"]["structures"][index]


def is_bright_cyan(r, g, b):
    return r < 120 and g > 150 and b > 180


def is_hatching(r, g, b):
    return r > g + 30 and g > b + 30
