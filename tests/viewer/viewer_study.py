#!/usr/bin/env python3
"""How quick the viewer is: what a frame costs, how long an image is on its way, how long outlining by hand takes.

Usage: viewer_study.py FATHOM. Prints the figures of docs/results.md; fails where one is missed.
"""

import json
import math
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from viewer_driver import DUMP, IDLE, at, run_all  # noqa: E402

CLICK_S, DRAG_S_PER_PX = 1.0, 0.3 / 100  # of the scripted user


def fathom(program, *arguments):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


class Shared:
    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        self.scan = folder / "scan.mha"
        fathom(program, "simulate", "--object", "kidney", "--pattern", "free", "--frames", 300, "--speckle", "--out", self.scan)
        self.calibration = folder / "scan.calibration.json"
        contours = json.loads((folder / "scan.contours.json").read_text())
        self.outlines = {c["frame"]: c["points"] for c in contours["structures"][0]["contours"] if "points" in c}
        self.volume_ml = json.loads((folder / "scan.truth.json").read_text())["volume_ml"]

    def contours(self, folder, frames):
        path = folder / "contours.json"
        path.write_text(json.dumps({"fathom_contours": 1, "structures": [
            {"name": "kidney", "color": "#33ccff",
             "contours": [{"frame": f, "closed": True, "points": self.outlines[f]} for f in frames]}]}))
        return path

    def spread(self, count):
        frames = sorted(self.outlines)
        return [frames[round(i * (len(frames) - 1) / (count - 1))] for i in range(count)]


def frame_costs_little(viewer, shared):
    contours = shared.contours(viewer.folder, shared.spread(40))
    run = viewer.run(shared.scan, "--calibration", shared.calibration, "--contours", contours, window=(1280, 800),
                     events=[IDLE, {"frames": 20}, {"bench": "bench.json", "count": 300}, DUMP])
    bench = run.state("bench")
    triangles = run.state()["document"]["structures"][0]["triangles"]
    print(f"        frame of the interface: median {bench['median_ms']:.2f} ms, 95 % below {bench['p95_ms']:.2f} ms, "
          f"300 frames, 40 sections, {triangles} triangles")
    assert bench["median_ms"] <= 4.0


def image_is_shown_soon(viewer, shared):
    run = viewer.run(window=(1000, 760), events=[
        {"frames": 3}, {"key": "F4"}, {"frames": 3}, {"click": "image source"}, {"text": f"replay:{shared.scan}"},
        {"click": "Connect"}, {"wait_s": 0.3}, {"click": "recording folder"}, {"key": "Ctrl+A"},
        {"text": str(viewer.folder / "sweep")}, {"click": "Record"}, {"wait_s": 5.0}, DUMP])
    live = run.state()["live"]
    print(f"        from arrival to picture: 95 % within {1000 * live['delay_p95_s']:.1f} ms at {live['rate_hz']:.0f} frames/s, "
          "recording")
    assert live["delay_p95_s"] <= 0.05


def outlining_by_hand_is_quick(viewer, shared):
    frames = shared.spread(10)[1:-1]
    events, clock_s = [IDLE, {"click": "Draw"}], CLICK_S
    for frame in frames:
        points = shared.outlines[frame][::4]
        events += [{"click": {"item": "pane:Timeline", "at": [(frame + 0.5) / 300, 0.7]}}, IDLE,
                   {"drag": [at(*p) for p in points + points[:1]]}]
        length = sum(math.dist(a, b) for a, b in zip(points, points[1:] + points[:1]))
        clock_s += 2 * CLICK_S + DRAG_S_PER_PX * length
    run = viewer.run(shared.scan, "--calibration", shared.calibration, window=(1280, 800), events=events + [IDLE, DUMP])
    volume = run.state()["document"]["structures"][0]["volume_ml"]
    off = 100 * (volume / shared.volume_ml - 1)
    print(f"        8 sections by hand: {clock_s:.0f} s of the scripted clock, {volume:.1f} ml, {off:+.1f} % of the truth")
    assert clock_s <= 150


if __name__ == "__main__":
    sys.exit(run_all([frame_costs_little, image_is_shown_soon, outlining_by_hand_is_quick], sys.argv[1], Shared))
