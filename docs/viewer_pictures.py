#!/usr/bin/env python3
"""Makes the pictures and the table of keys of docs/viewer.md from the real program.

Usage: viewer_pictures.py FATHOM (`./dev pictures`). Simulates a patient and drives the viewer under Xvfb.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "tests" / "viewer")]
from small_png import small  # noqa: E402
from viewer_driver import IDLE, Display, Viewer, at  # noqa: E402

WINDOW = (1100, 700)
KEYS_BEGIN, KEYS_END = "<!-- keys -->\n", "<!-- end of keys -->\n"


def fathom(program, *arguments):
    subprocess.run([program, *map(str, arguments)], check=True, stdout=subprocess.DEVNULL)


def thinned(source, target, every, points, left_out=()):
    """A contours file with some of the outlines of another, and fewer points in each."""
    contours = json.loads(source.read_text())
    for structure in contours["structures"]:
        outlined = [c for c in structure["contours"] if "points" in c][::every]
        for contour in outlined:
            contour["points"] = contour["points"][::max(1, len(contour["points"]) // points)]
        structure["contours"] = [c for c in outlined if c["frame"] not in left_out]
    target.write_text(json.dumps(contours))
    return contours["structures"][0]["contours"]


def main():
    program = Path(sys.argv[1]).resolve()
    images = HERE / "images"
    with tempfile.TemporaryDirectory() as top, Display() as display:
        folder = Path(top)
        fathom(program, "simulate", "--object", "kidney", "--pattern", "free", "--frames", 80, "--speckle", "--seed", 3,
               "--out", folder / "scan.mha")
        fathom(program, "simulate", "--object", "kidney", "--pattern", "sweeps-b", "--frames", 60, "--speckle", "--out",
               folder / "pair.mha")
        outlines = thinned(folder / "scan.contours.json", folder / "outlines.json", 6, 24)
        thinned(folder / "pair.contours.json", folder / "pair.json", 5, 24)
        for name, contours in (("scan", "outlines"), ("pair", "pair")):
            fathom(program, "exam", "create", folder / f"{name} exam", "--recording", folder / f"{name}.mha", "--calibration",
                   folder / f"{name}.calibration.json", "--contours", folder / f"{contours}.json", "--patient", "simulated")
        viewer = Viewer(program, display, folder)
        middle = outlines[len(outlines) // 2]["points"]
        half = [at(*p) for p in middle[:14]]
        picture = lambda name, **of: {"picture": f"{name}.png", **of}  # noqa: E731
        first = viewer.run(folder / "scan exam", window=WINDOW, events=[
            IDLE, {"frames": 3}, picture("viewer-window"), picture("viewer-outline", of="pane:Outline"),
            picture("viewer-reslice", of="pane:Reslice"), picture("viewer-measurements", of="pane:Measurements"),
            picture("viewer-timeline", of="pane:Timeline"), {"key": "Shift+Delete"}, {"key": "D"}, {"move": half[0]},
            {"frames": 1}, {"press": 0}, *[{"move": p} for p in half[1:]], {"frames": 2}, picture("viewer-draw", of="pane:Review"),
            {"release": 0}, {"frames": 2}, {"key": "Ctrl+Z"}, {"key": "Ctrl+Z"}, IDLE, {"key": "U"}, {"move": at(*middle[3])},
            {"frames": 2}, picture("viewer-push", of="pane:Review"), {"key": "F1"}, {"frames": 3},
            picture("viewer-help", of="pane:Help"), {"keys": "keys.md"}])
        second = viewer.run(folder / "pair exam", window=WINDOW, events=[
            IDLE, {"click": "Dividing planes"}, {"click": "Place planes"}, IDLE, {"frames": 3}, picture("viewer-planes")])
        live = viewer.run(window=WINDOW, events=[
            {"frames": 3}, {"key": "F4"}, {"frames": 3}, {"click": "image source"},
            {"text": "replay:../scan.mha"}, {"click": "Connect"}, {"wait_s": 1.0}, {"click": "recording folder"},
            {"key": "Ctrl+A"}, {"text": "sweep"}, {"click": "Record"}, {"wait_s": 1.0}, picture("viewer-live")])
        for run in (first, second, live):
            for path in sorted(run.folder.glob("*.png")):
                picture_file = images / path.name
                picture_file.write_bytes(small(path.read_bytes()))
                print(f"docs/images/{path.name}: {picture_file.stat().st_size // 1000} kB")
        guide = HERE / "viewer.md"
        before, rest = guide.read_text().split(KEYS_BEGIN)
        after = rest.split(KEYS_END)[1]
        guide.write_text(before + KEYS_BEGIN + (first.folder / "keys.md").read_text() + KEYS_END + after)


if __name__ == "__main__":
    main()
