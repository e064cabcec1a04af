#!/usr/bin/env python3
"""How quick the viewer is: what a frame costs, how long an image is on its way, how long outlining by hand takes.

Usage: viewer_study.py FATHOM. Prints the figures of docs/results.md; fails where one is missed.
"""

import json
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from viewer_driver import DUMP, IDLE, at, run_all  # noqa: E402
from viewer_exams import fathom  # noqa: E402

CLICK_S, DRAG_S_PER_PX = 1.0, 0.3 / 100  # of the scripted user


class Shared:
    """Two speckled scans with their true outlines: a kidney, and the bladder that a scripted user outlines."""

    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        self.kidney = Scan(program, folder, "kidney", 300)
        self.bladder = Scan(program, folder, "bladder", 100)


class Scan:
    def __init__(self, program, folder, name, frames):
        self.name, self.frames, self.path = name, frames, folder / f"{name}.mha"
        fathom(program, "simulate", "--object", name, "--pattern", "free", "--frames", frames, "--speckle",
               "--out", self.path)
        self.calibration = folder / f"{name}.calibration.json"
        contours = json.loads((folder / f"{name}.contours.json").read_text())
        self.outlines = {c["frame"]: c["points"] for c in contours["structures"][0]["contours"] if "points" in c}
        self.volume_ml = json.loads((folder / f"{name}.truth.json").read_text())["volume_ml"]

    def contours(self, folder, frames, structures):
        path = folder / "contours.json"
        contours = [{"frame": f, "closed": True, "points": self.outlines[f]} for f in frames]
        path.write_text(json.dumps({"fathom_contours": 1, "structures": [
            {"name": f"{self.name} {i}", "color": "#33ccff", "contours": contours} for i in range(structures)]}))
        return path

    def spread(self, count):
        frames = sorted(self.outlines)
        return [frames[round(i * (len(frames) - 1) / (count - 1))] for i in range(count)]


def frame_costs_little(viewer, shared):
    scan = shared.kidney
    contours = scan.contours(viewer.folder, scan.spread(40), 9)  # each surface has some 12 000 triangles
    run = viewer.run(scan.path, "--calibration", scan.calibration, "--contours", contours, window=(1280, 800),
                     events=[IDLE, {"frames": 20}, {"bench": "bench.json", "count": 300}, DUMP])
    bench = run.state("bench")
    triangles = sum(structure["triangles"] for structure in run.state()["document"]["structures"])
    print(f"        frame of the interface: median {bench['median_ms']:.2f} ms, 95 % below {bench['p95_ms']:.2f} ms, "
          f"{scan.frames} frames, 40 sections, {triangles} triangles")
    assert triangles >= 100_000
    assert bench["median_ms"] <= 4.0


def image_is_shown_soon(viewer, shared):
    source = f"replay:{shared.kidney.path}?speed=2.4"  # 25 frames/s as recorded
    run = viewer.run(window=(1000, 760), events=[
        {"frames": 3}, {"key": "F4"}, {"frames": 3}, {"click": "image source"}, {"key": "Ctrl+A"}, {"text": source},
        {"click": "Connect"}, {"wait_s": 0.4}, {"click": "recording folder"}, {"key": "Ctrl+A"},
        {"text": str(viewer.folder / "sweep")}, {"click": "Record"}, {"wait_s": 4.0}, DUMP])
    live = run.state()["live"]
    print(f"        from arrival to picture: 95 % within {1000 * live['delay_p95_s']:.1f} ms at "
          f"{live['rate_hz']:.0f} frames/s, recording")
    assert live["recording"] and live["rate_hz"] > 55
    assert live["delay_p95_s"] <= 0.05


def show(frame, scan):
    return {"click": {"item": "pane:Timeline", "at": [(frame + 0.5) / scan.frames, 0.7]}}


def outlined(viewer, scan, events, clock_s, how, limit_s):
    run = viewer.run(scan.path, "--calibration", scan.calibration, window=(1280, 800), events=events + [IDLE, DUMP])
    structure = run.state()["document"]["structures"][0]
    off = 100 * (structure["volume_ml"] / scan.volume_ml - 1)
    sections = len({contour["frame"] for contour in structure["contours"]})
    print(f"        {sections} sections {how}: {clock_s:.0f} s of the scripted clock, {structure['volume_ml']:.1f} ml, "
          f"{off:+.1f} % of the truth")
    assert sections == 8 and abs(off) <= 3.0 and clock_s <= limit_s


def outlining_by_hand_is_quick(viewer, shared):
    scan = shared.bladder
    events, clock_s = [IDLE, {"key": "D"}], CLICK_S
    for frame in scan.spread(8):
        points = scan.outlines[frame][::4]
        events += [show(frame, scan), IDLE, {"drag": [at(*p) for p in points + points[:1]]}]
        length = sum(math.dist(a, b) for a, b in zip(points, points[1:] + points[:1]))
        clock_s += 2 * CLICK_S + DRAG_S_PER_PX * length
    outlined(viewer, scan, events, clock_s, "by hand", 150)


def outlining_by_wire_is_quicker(viewer, shared):
    scan = shared.bladder
    events, clock_s = [IDLE, {"key": "E"}], CLICK_S
    for frame in scan.spread(8):
        points, clicks = scan.outlines[frame], 5
        seeds = [points[round(i * len(points) / clicks)] for i in range(clicks)]
        events += [show(frame, scan), IDLE, {"move": at(*seeds[0])}, IDLE]
        events += [{"click": at(*seed)} for seed in seeds] + [{"key": "Enter"}, IDLE]
        clock_s += (len(seeds) + 2) * CLICK_S
    outlined(viewer, scan, events, clock_s, "by wire", 60)


if __name__ == "__main__":
    sys.exit(run_all([frame_costs_little, image_is_shown_soon, outlining_by_hand_is_quick, outlining_by_wire_is_quicker],
                     sys.argv[1], Shared, at_once=1))
