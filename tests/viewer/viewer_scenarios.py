#!/usr/bin/env python3
"""What users do in the viewer, by mouse and keys on the real window; each asserts on the model and on pixels.

Usage: viewer_scenarios.py FATHOM [SCENARIO...]
"""

import json
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "cli"))
from unplugged_devices import deeper_recording  # noqa: E402
from viewer_driver import DUMP, IDLE, at, picture, run_all  # noqa: E402


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
        return out["structures"][0]["volume_ml"][out["structures"][0]["recommended"]]


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


# Looking.

def exam_is_shown(viewer, shared):
    run = viewer.run(shared.exam(viewer.folder), events=[IDLE, DUMP, picture(of="pane:Review"), picture("space", "pane:Outline")])
    state = run.state()
    assert state["view"]["frames"] == 12 and state["document"]["calibrated"]
    assert len(structure(state)["contours"]) == 7 and structure(state)["triangles"] > 500
    assert run.picture().count(is_bright_cyan) > 200, "no outline is drawn"
    assert run.picture().count(lambda r, g, b: r == g == b == 255) > 1000, "the organ is not seen"
    assert run.picture("space").count(lambda r, g, b: b > r + 40 and g > r + 30) > 300, "no surface is drawn"


def recording_without_calibration_has_no_volume(viewer, shared):
    run = viewer.run(shared.scan, events=drawing(shared, shared.frames[2:5]) + [IDLE, DUMP])
    state = run.state()
    assert not state["document"]["calibrated"] and len(structure(state)["contours"]) == 3
    assert structure(state)["volume_ml"] is None


def dropped_calibration_gives_the_volume(viewer, shared):
    run = viewer.run(shared.scan, events=drawing(shared, shared.frames[2:5]) +
                     [IDLE, {"drop": str(shared.calibration)}, IDLE, DUMP])
    assert run.state()["document"]["calibrated"] and structure(run.state())["volume_ml"] > 0.3


def dropped_exam_is_opened(viewer, shared):
    exam = shared.exam(viewer.folder)
    run = viewer.run(events=[IDLE, {"drop": str(exam)}, IDLE, DUMP, picture(of="pane:Review")])
    assert run.state()["document"]["title"] == "exam" and str(exam) in run.state()["recent"]
    assert run.picture().count(is_bright_cyan) > 200


def frames_are_stepped_through(viewer, shared):
    frames = []
    events = [IDLE]
    steps = [({"key": "Home"}, 0), ({"key": "Right"}, 1), ({"key": "Page Down"}, 11), ({"key": "Left"}, 10),
             ({"wheel": 3, "at": "pane:Review"}, 7), ({"wheel": -2, "at": "pane:Review"}, 9), ({"key": "End"}, 11)]
    for i, (event, _) in enumerate(steps):
        events += [event, IDLE, {"dump": f"s{i}.json"}]
    run = viewer.run(*recording(shared), events=events + [picture(of="pane:Timeline")])
    frames = [run.state(f"s{i}")["view"]["frame"] for i in range(len(steps))]
    assert frames == [wanted for _, wanted in steps], frames
    timeline = run.picture()
    yellow = [x for x in range(timeline.width) if timeline.at(x, timeline.height // 2)[0] > 200]
    assert yellow and min(yellow) > 0.9 * timeline.width, "the timeline does not show the last frame"


def timeline_is_dragged(viewer, shared):
    run = viewer.run(*recording(shared), events=[
        IDLE, picture("before", "pane:Review"), {"drag": [{"item": "pane:Timeline", "at": [0.5, 0.5]},
                       {"item": "pane:Timeline", "at": [0.2, 0.5]}]}, IDLE, DUMP, picture(of="pane:Review")])
    assert run.state()["view"]["frame"] == 2
    assert run.picture().differs(run.picture("before")) > 500


def image_is_zoomed_and_moved(viewer, shared):
    run = viewer.run(*recording(shared), events=[
        IDLE, picture("whole", "pane:Review"), {"wheel": 5, "at": "pane:Review", "held": "Ctrl"}, {"dump": "zoomed.json"},
        picture("zoomed", "pane:Review"), {"drag": [at(200, 200), at(230, 200)], "button": "middle"}, DUMP,
        picture("moved", "pane:Review"), {"key": "F"}, {"frames": 2}, picture("again", "pane:Review")])
    assert run.state("zoomed")["view"]["zoom"] > 1.0
    assert run.picture("zoomed").differs(run.picture("whole")) > 500
    assert run.picture("moved").differs(run.picture("zoomed")) > 200
    assert run.picture("again").differs(run.picture("whole")) == 0


def grey_values_follow_the_right_button(viewer, shared):
    run = viewer.run(*recording(shared), events=[
        IDLE, {"drag": [at(100, 100), at(260, 100)], "button": "right"}, DUMP, picture("wide", "pane:Review"), {"key": "W"},
        {"frames": 2}, {"dump": "usual.json"}, picture("usual", "pane:Review")])
    assert run.state()["view"]["window"] > 300 and run.state("usual")["view"]["window"] == 255
    white = lambda r, g, b: r == g == b == 255  # noqa: E731
    assert run.picture("usual").count(white) > 1000 > run.picture("wide").count(white)


def real_spine_sweep_is_opened(viewer, shared):
    data = Path(__file__).resolve().parents[3] / "shared" / "data" / "plus"
    if not data.exists():
        print("        the recordings of shared/data are not beside this checkout")
        return
    info = json.loads(fathom(shared.program, "info", data / "SpinePhantomFreehand.igs.mha", "--json"))
    run = viewer.run(data / "SpinePhantomFreehand.igs.mha", "--calibration",
                     data / "PlusDeviceSet_SpinePhantomFreehandReconstructionOnly.xml", events=[
                         IDLE, {"key": "D"}, {"drag": [at(150, 150), at(260, 150), at(260, 260), at(150, 260), at(150, 150)]},
                         {"key": "Right"}, IDLE, DUMP, picture(of="pane:Review"), picture("space", "pane:Outline")])
    assert run.state()["view"]["frames"] == info["frames"] and run.state()["document"]["calibrated"]
    assert len(structure(run.state())["contours"]) == 1
    assert run.picture().count(lambda r, g, b: r == g == b and 20 < r < 235) > 5000, "no B-scan is seen"
    assert run.picture("space").count(lambda r, g, b: r > 50) > 500, "no frames are drawn in space"


# Outlining.

def five_frames_outlined_by_dragging(viewer, shared):
    frames = shared.frames[1:10:2]
    run = viewer.run(*recording(shared), events=drawing(shared, frames) + [IDLE, DUMP, picture(of="pane:Review")])
    drawn = structure(run.state())
    assert [c["frame"] for c in drawn["contours"]] == frames and drawn["sections"] == 5
    true = {"fathom_contours": 1, "structures": [
        {"name": "true", "color": "#ffffff",
         "contours": [{"frame": f, "closed": True, "points": shared.outlines[f]} for f in frames]}]}
    wanted = shared.measured_ml(viewer.folder, json.dumps(true))
    assert abs(drawn["volume_ml"] / wanted - 1) < 0.02, (drawn["volume_ml"], wanted)
    own = shared.measured_ml(viewer.folder, run.state()["document"]["contours_text"])
    assert abs(drawn["volume_ml"] / own - 1) < 1e-9, "the pane shows another volume than `fathom measure`"
    assert drawn["triangles"] > 500 and abs(drawn["surface_ml"] / drawn["volume_ml"] - 1) < 0.05
    assert run.picture().count(lambda r, g, b: g > 120 and abs(r - g) + abs(g - b) > 100) > 150


def outline_set_point_by_point(viewer, shared):
    points = shared.loop(5, 8)
    clicks = [{"click": at(*p)} for p in points]
    run = viewer.run(*recording(shared), events=[IDLE, {"key": "D"}, *go_to(5), *clicks, {"dump": "open.json"},
                                                 {"click": at(*points[0])}, IDLE, DUMP])
    assert len(run.state("open")["view"]["line"]) == 8 and not run.state("open")["document"]["structures"]
    contour = structure(run.state())["contours"][0]
    assert len(contour["points"]) == 8 and contour["closed"] and run.state()["view"]["line"] == []
    assert max(abs(a - b) for p, q in zip(points, contour["points"]) for a, b in zip(p, q)) < 1.5


def last_points_removed_while_drawing(viewer, shared):
    clicks = [{"click": at(*p)} for p in shared.loop(5, 4)]
    run = viewer.run(*recording(shared), events=[IDLE, {"key": "D"}, *go_to(5), *clicks, {"key": "Backspace"},
                                                 {"dump": "three.json"}, {"key": "Ctrl+Z"}, {"key": "Backspace"},
                                                 {"key": "Backspace"}, {"key": "Backspace"}, {"key": "Ctrl+Z"}, DUMP])
    assert len(run.state("three")["view"]["line"]) == 3
    assert run.state()["view"]["line"] == [] and run.state()["document"]["edits"] == 0


def line_given_up(viewer, shared):
    clicks = [{"click": at(*p)} for p in shared.loop(5, 4)]
    run = viewer.run(*recording(shared), events=[IDLE, {"key": "D"}, *go_to(5), picture("empty", "pane:Review"), *clicks,
                                                 {"key": "Escape"}, {"move": [3, 3]}, {"frames": 2}, DUMP,
                                                 picture(of="pane:Review")])
    assert run.state()["view"]["line"] == [] and run.picture().differs(run.picture("empty")) == 0


def undone_to_nothing_and_redone_to_the_same_bytes(viewer, shared):
    undo = [{"key": "Ctrl+Z"}] * 4
    redo = [{"key": "Ctrl+Y"}] * 4
    run = viewer.run(*recording(shared), events=drawing(shared, shared.frames[2:6]) + [
        IDLE, {"dump": "drawn.json"}, *undo, IDLE, {"dump": "nothing.json"}, picture("nothing", "pane:Review"), *redo,
        IDLE, DUMP, picture(of="pane:Review")])
    drawn, nothing, again = run.state("drawn"), run.state("nothing"), run.state()
    assert nothing["document"]["structures"] == [] and nothing["document"]["edits_done"] == 0
    assert again["document"]["contours_text"] == drawn["document"]["contours_text"]
    assert structure(again)["volume_ml"] == structure(drawn)["volume_ml"]
    assert run.picture().differs(run.picture("nothing")) > 100


def undone_after_saving_and_loading(viewer, shared):
    exam = shared.exam(viewer.folder)
    viewer.run(exam, events=drawing(shared, shared.frames[9:10]) + [IDLE, {"key": "Ctrl+S"}, IDLE, {"dump": "saved.json"}])
    run = viewer.run(exam, events=[IDLE, {"dump": "loaded.json"}, {"key": "Ctrl+Z"}, IDLE, DUMP])
    assert len(structure(run.state("loaded"))["contours"]) == 8 and not run.state("loaded")["document"]["modified"]
    assert len(structure(run.state())["contours"]) == 7 and run.state()["document"]["modified"]


def points_moved_inserted_and_deleted(viewer, shared):
    frame, points = shared.frames[4], shared.loop(shared.frames[4], 16)
    middle = [(points[0][i] + points[1][i]) / 2 for i in range(2)]
    outward = [points[4][0] + 25, points[4][1] + 10]
    run = viewer.run(shared.exam(viewer.folder), events=[
        IDLE, {"key": "P"}, *go_to(frame), {"dump": "before.json"}, {"click": at(*points[4])}, {"dump": "clicked.json"},
        {"drag": [at(*points[4]), at(*outward)]}, IDLE, {"dump": "moved.json"}, {"drag": [at(*middle), at(middle[0], middle[1] + 4)]},
        IDLE, {"dump": "inserted.json"}, {"key": "Delete"}, IDLE, DUMP])
    count = lambda name: len(next(c for c in structure(run.state(name))["contours"] if c["frame"] == frame)["points"])  # noqa: E731
    assert run.state("clicked")["document"]["edits"] == 0, "a click that moves nothing was pushed"
    assert count("moved") == 16 and run.state("moved")["document"]["edits"] == 1
    assert structure(run.state("moved"))["volume_ml"] != structure(run.state("before"))["volume_ml"]
    assert structure(run.state("moved"))["volume_before_ml"] == structure(run.state("before"))["volume_ml"]
    assert (count("inserted"), count("state")) == (17, 16)
    surfaces = [structure(run.state(name))["surface_ml"] for name in ("before", "moved")]
    assert surfaces[1] > surfaces[0], "the surface did not follow"


def outline_pushed_with_the_brush(viewer, shared):
    frame = shared.frames[4]
    points = shared.outlines[frame]
    middle = [sum(p[i] for p in points) / len(points) for i in range(2)]
    right = max(p[0] for p in points)
    run = viewer.run(shared.exam(viewer.folder), events=[
        IDLE, {"key": "U"}, *go_to(frame), {"dump": "before.json"}, {"drag": [at(*middle), at(right - 5, middle[1])]},
        IDLE, DUMP, {"drag": [at(5, 5), at(8, 8)]}, {"dump": "beside.json"}])
    assert structure(run.state())["volume_ml"] > structure(run.state("before"))["volume_ml"] + 0.01
    assert run.state()["document"]["edits"] == 1 == run.state("beside")["document"]["edits"]


def hole_is_subtracted(viewer, shared):
    frame = shared.frames[4]
    points = shared.outlines[frame]
    middle = [sum(p[i] for p in points) / len(points) for i in range(2)]
    hole = [[middle[0] + 0.4 * (p[0] - middle[0]), middle[1] + 0.4 * (p[1] - middle[1])] for p in shared.loop(frame, 24)]
    run = viewer.run(shared.exam(viewer.folder), events=[IDLE, {"dump": "before.json"}, {"key": "D"}, *go_to(frame), draw(hole),
                                                         IDLE, DUMP])
    before, after = structure(run.state("before")), structure(run.state())
    assert len(after["contours"]) == 8 and after["sections"] == before["sections"]
    assert after["volume_ml"] < before["volume_ml"] - 0.01


def crossing_outline_is_refused_beside_it(viewer, shared):
    frame = shared.frames[4]
    p = shared.loop(frame, 16)
    shifted = [[x + 30, y] for x, y in p]
    run = viewer.run(shared.exam(viewer.folder), events=[IDLE, {"key": "D"}, *go_to(frame), draw(shifted), IDLE, DUMP,
                                                         {"key": "Ctrl+Z"}, IDLE, {"dump": "undone.json"}])
    said = "".join(structure(run.state())["warnings"]) + "".join(m["text"] for m in run.state()["messages"])
    assert "cross" in said and (structure(run.state())["volume_ml"] is None or run.state()["messages"])
    assert structure(run.state("undone"))["volume_ml"] > 0.3


def absent_and_extremity_marks(viewer, shared):
    last = shared.frames[9]
    run = viewer.run(shared.exam(viewer.folder), events=[
        IDLE, *go_to(last), {"key": "A"}, IDLE, {"dump": "absent.json"}, picture("absent", "pane:Review"), {"key": "A"},
        {"key": "X"}, {"click": at(200, 200)}, IDLE, DUMP, {"key": "Shift+Delete"}, IDLE, {"dump": "cleared.json"}])
    assert structure(run.state("absent"))["absent"] == [last]
    after = structure(run.state())
    assert after["absent"] == [] and after["extremities"] == [last] and after["sections"] == 8
    assert structure(run.state("cleared"))["extremities"] == []


def second_structure_has_its_own_outlines(viewer, shared):
    run = viewer.run(shared.exam(viewer.folder), events=[
        IDLE, {"click": "Add structure"}, {"click": "name1", "times": 2}, {"key": "Ctrl+A"}, {"text": "stone"}, {"key": "Enter"},
        {"key": "D"}, *go_to(9), draw(shared.loop(9, 24)), *go_to(10), draw(shared.loop(10, 24)), IDLE, DUMP,
        picture(of="pane:Review")])
    first, second = structure(run.state()), structure(run.state(), 1)
    assert second["name"] == "stone" and len(second["contours"]) == 2 and len(first["contours"]) == 7
    assert second["color"] != first["color"] and second["volume_ml"] > 0


# Space, planes, other panes.

def space_is_turned(viewer, shared):
    run = viewer.run(shared.exam(viewer.folder), events=[
        IDLE, picture("before", "pane:Outline"), {"drag": [{"item": "pane:Outline", "at": [0.3, 0.5]},
                                                           {"item": "pane:Outline", "at": [0.7, 0.6]}]},
        {"frames": 2}, picture("turned", "pane:Outline"), {"key": "V"}, {"frames": 2}, picture("again", "pane:Outline"),
        {"wheel": 3, "at": "pane:Outline"}, {"frames": 2}, picture("near", "pane:Outline"), {"key": "S"}, {"frames": 2},
        picture("bare", "pane:Outline")])
    assert run.picture("turned").differs(run.picture("before")) > 300
    assert run.picture("again").differs(run.picture("before")) < 100
    cyan = lambda r, g, b: b > r + 40 and g > r + 30  # noqa: E731
    assert run.picture("near").count(cyan) > run.picture("again").count(cyan) > run.picture("bare").count(cyan)


def dividing_plane_moves_hatching_and_volume(viewer, shared):
    exam = viewer.folder / "pair"
    fathom(shared.program, "exam", "create", exam, "--recording", shared.pair, "--calibration", shared.pair_calibration,
           "--contours", shared.pair_contours)
    run = viewer.run(exam, window=(1100, 800), events=[
        IDLE, {"click": "Dividing planes"}, {"click": "Place planes"}, IDLE, {"dump": "placed.json"},
        picture("placed", "pane:Review"), {"drag": ["plane 1", {"item": "plane 1", "at": [3.0, 3.0]}]}, IDLE, DUMP,
        picture(of="pane:Review"), {"key": "H"}, {"frames": 2}, picture("bare", "pane:Review"), {"key": "Ctrl+Z"}, IDLE,
        {"dump": "undone.json"}])
    placed, moved = run.state("placed"), run.state()
    assert len(placed["document"]["planes"]) >= 1
    assert moved["document"]["planes"][0] != placed["document"]["planes"][0]
    assert structure(moved)["volume_ml"] != structure(placed)["volume_ml"]
    assert run.state("undone")["document"]["planes"] == placed["document"]["planes"]
    hatched = [run.picture(name).count(is_hatching) for name in ("placed", "picture", "bare")]
    assert hatched[0] != hatched[1] and max(hatched[:2]) > hatched[2] + 100, hatched


def rulers_measure(viewer, shared):
    run = viewer.run(*recording(shared), events=[
        IDLE, {"key": "M"}, {"click": at(100, 100)}, {"click": at(200, 100)}, {"frames": 1}, {"dump": "distance.json"},
        {"key": "N"}, {"click": at(100, 200)}, {"click": at(200, 200)}, {"click": at(200, 100)}, {"dump": "angle.json"},
        {"key": "R"}, {"click": at(100, 100)}, {"click": at(200, 100)}, {"click": at(200, 200)}, {"click": at(100, 200)},
        {"frames": 1}, DUMP, picture(of="pane:Review")])
    matrix = json.loads(shared.calibration.read_text())["image_to_probe"]
    pixel = sum(matrix[4 * i] ** 2 for i in range(3)) ** 0.5
    down = sum(matrix[4 * i + 1] ** 2 for i in range(3)) ** 0.5
    assert abs(float(run.state("distance")["view"]["ruler_text"].split()[0]) - 100 * pixel) < 1.5 * pixel
    assert abs(float(run.state("angle")["view"]["ruler_text"].rstrip("°")) - 90) < 1.5
    area = float(run.state()["view"]["ruler_text"].split()[0])
    assert abs(area / (100 * pixel * 100 * down / 100) - 1) < 0.03, area
    assert run.picture().count(lambda r, g, b: r > 200 and g > 180 and b < 120) > 100


def reslice_planes_follow_their_handles(viewer, shared):
    run = viewer.run(*recording(shared), window=(1100, 800), events=[
        IDLE, {"dump": "before.json"}, picture("before", "pane:Reslice"),
        {"drag": ["cut 1 move", {"item": "cut 1 move", "at": [0.5, 3.0]}]}, IDLE, {"dump": "moved.json"},
        {"drag": ["cut 2 turn last", {"item": "cut 2 turn last", "at": [4.0, 4.0]}]}, IDLE, DUMP, picture(of="pane:Reslice")])
    planes = [run.state(name)["reslices"] for name in ("before", "moved", "state")]
    assert planes[1][1]["centre_mm"] != planes[0][1]["centre_mm"] and planes[1][1]["normal"] == planes[0][1]["normal"]
    assert planes[2][0]["normal"] != planes[1][0]["normal"]
    dot = sum(a * b for a, b in zip(planes[0][0]["normal"], planes[0][1]["normal"]))
    assert abs(dot) < 1e-9, "the planes do not start perpendicular"
    assert planes[2][1]["picture"] > planes[0][1]["picture"] and run.picture().differs(run.picture("before")) > 300


# The window.

def light_and_larger(viewer, shared):
    run = viewer.run(*recording(shared), events=[IDLE, {"key": "Ctrl+L"}, {"key": "Ctrl+="}, {"frames": 2}, DUMP, picture()])
    assert not run.state()["settings"]["dark"] and abs(run.state()["settings"]["scale"] - 1.1) < 1e-3
    assert run.picture().at(run.picture().width - 4, 200)[0] > 200
    again = viewer.run(events=[{"frames": 3}, DUMP])
    assert not again.state()["settings"]["dark"], "the look was not kept"


def panes_are_resized_and_kept(viewer, shared):
    run = viewer.run(*recording(shared), events=[IDLE, {"drag": ["split:left", {"item": "split:left", "at": [-20, 0.5]}]},
                                                 {"key": "F7"}, {"frames": 2}, DUMP])
    again = viewer.run(*recording(shared), events=[IDLE, DUMP])
    left = run.state()["settings"]["left"]
    assert left < 0.49 and again.state()["settings"]["left"] == left


def help_page_shows_the_keys(viewer, shared):
    run = viewer.run(events=[{"frames": 3}, picture("before"), {"key": "F1"}, {"frames": 3}, picture("help"),
                             {"key": "F1"}, {"frames": 3}, picture("after"), {"menu": "Help/Keys and mouse"},
                             {"frames": 3}, picture("menu", "pane:Help")])
    assert run.picture("help").differs(run.picture("before")) > 5000
    assert run.picture("after").differs(run.picture("before")) < 100
    assert run.picture("menu").width > 300


def saved_as_an_exam(viewer, shared):
    target = viewer.folder / "new exam"
    run = viewer.run(*recording(shared), events=drawing(shared, shared.frames[2:5]) + [
        IDLE, {"menu": "File/Save as..."}, {"key": "Ctrl+A"}, {"text": str(target)}, {"key": "Enter"}, IDLE, DUMP])
    assert run.state()["document"]["folder"] == str(target) and not run.state()["document"]["modified"]
    listed = json.loads((target / "exam.json").read_text())
    assert json.loads((target / listed["structures"]).read_text())["structures"]
    assert run.state()["recent"][0] == str(target)


def work_is_found_again_after_a_kill(viewer, shared):
    exam = shared.exam(viewer.folder)
    folder, process = viewer.start(exam, events=drawing(shared, [9, 10]) + [IDLE, {"wait_s": 0.5}, DUMP, {"wait_s": 60}])
    for _ in range(400):
        if (folder / "state.json").exists():
            break
        time.sleep(0.1)
    process.kill()
    process.wait()
    drawn = json.loads((folder / "state.json").read_text())
    run = viewer.run(exam, events=[IDLE, picture("asked"), {"click": "Recover"}, IDLE, DUMP, {"key": "Ctrl+Z"}, IDLE,
                                   {"dump": "undone.json"}])
    assert run.state()["document"]["contours_text"] == drawn["document"]["contours_text"]
    assert len(structure(run.state())["contours"]) == 9 and len(structure(run.state("undone"))["contours"]) == 8


# Live.

def live_sweep_is_recorded_and_reviewed(viewer, shared):
    target = viewer.folder / "sweep"
    source = f"replay:{shared.timed}"
    run = viewer.run(window=(1000, 760), events=[
        {"frames": 3}, {"key": "F4"}, {"frames": 3}, {"click": "image source"}, {"key": "Ctrl+A"}, {"text": source}, {"click": "Connect"},
        {"wait_s": 0.4}, {"click": "recording folder"}, {"key": "Ctrl+A"}, {"text": str(target)}, {"click": "Record"}, {"wait_s": 1.2},
        {"dump": "recording.json"}, picture("live", "pane:Live image"), {"click": "Pause"}, {"frames": 3},
        {"dump": "paused.json"}, {"click": "End"}, IDLE, {"frames": 3}, {"dump": "ended.json"}, {"click": "Review it"}, IDLE, DUMP])
    live = run.state("recording")["live"]
    assert live["connected"] and live["recording"] and live["frames"] > 5 and live["shown"] > 5, live
    assert run.picture("live").count(lambda r, g, b: r == g == b == 255) > 500, "the image is not shown"
    assert run.state("paused")["live"]["state"] == 0
    assert run.state("ended")["live"]["verdict"]["frames"] > 5
    assert (target / "sweep.mhd").exists() and run.state()["view"]["frames"] == run.state("ended")["live"]["verdict"]["frames"]


def another_depth_ends_the_use_of_the_calibration(viewer, shared):
    path, _ = deeper_recording(viewer.folder)
    target = viewer.folder / "sweep"
    run = viewer.run(window=(1000, 760), events=[
        {"frames": 3}, {"key": "F4"}, {"frames": 3}, {"click": "image source"}, {"key": "Ctrl+A"},
        {"text": f"replay:{path}?speed=2"}, {"click": "Connect"}, {"wait_s": 0.3}, {"dump": "before.json"},
        {"click": "recording folder"}, {"key": "Ctrl+A"}, {"text": str(target)}, {"click": "Record"}, {"wait_s": 3.5},
        DUMP, {"click": "End"}, IDLE, {"frames": 3}])
    assert run.state("before")["live"]["geometry_fault"] == ""
    assert "depth" in run.state()["live"]["geometry_fault"], run.state()["live"]
    header = (target / "sweep.mhd").read_text()
    assert "GeometryFault = " in header and "ImageStatus = INVALID" in header


def missing_source_is_a_message(viewer, shared):
    run = viewer.run(events=[{"frames": 3}, {"key": "F4"}, {"frames": 3}, {"click": "image source"}, {"key": "Ctrl+A"},
                             {"text": "replay:nothing.mha"}, {"click": "Connect"}, {"frames": 3}, DUMP])
    assert not run.state()["live"]["connected"]
    assert any("nothing.mha" in m["text"] for m in run.state()["messages"])


# What is wrong.

def faults_are_messages_and_the_exam_stays(viewer, shared):
    exam = shared.exam(viewer.folder)
    newer = viewer.folder / "newer"
    newer.mkdir()
    (newer / "exam.json").write_text('{"fathom_exam": 99, "recordings": ["a.mha"]}')
    half = viewer.folder / "half"
    half.mkdir()
    (half / "exam.json").write_text((exam / "exam.json").read_text()[:40])
    missing = viewer.folder / "missing"
    missing.mkdir()
    (missing / "exam.json").write_text((exam / "exam.json").read_text())
    events = [IDLE]
    for path in (newer, half, missing, viewer.folder / "nothing.mha"):
        events += [{"drop": str(path)}, IDLE]
    run = viewer.run(exam, events=events + [DUMP, picture(of="pane:Messages")])
    texts = [m["text"] for m in run.state()["messages"] if m["is_error"]]
    assert len(texts) == 4 and all(len(t) > 20 for t in texts), texts
    assert run.state()["document"]["title"] == "exam" and len(structure(run.state())["contours"]) == 7
    assert run.picture().count(lambda r, g, b: r > 180 and g < 140) > 100, "no message is shown"


def no_display_is_a_clear_line(viewer, shared):
    done = subprocess.run([shared.program, "view"], capture_output=True, text=True,
                          env={k: v for k, v in viewer.environment().items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")})
    assert done.returncode == 1 and done.stderr.startswith("fathom: error: display: "), done.stderr
    assert len(done.stderr.splitlines()) == 1


def damaged_scripts_are_refused(viewer, shared):
    run = viewer.run(events=[{"click": "no such thing"}], fails=True)
    assert run.code == 1 and "no such thing" in run.errors
    run = viewer.run(events=[{"jump": 1}], fails=True)
    assert run.code == 1 and "events[0]" in run.errors


SCENARIOS = [
    exam_is_shown, real_spine_sweep_is_opened, recording_without_calibration_has_no_volume, dropped_calibration_gives_the_volume,
    dropped_exam_is_opened, frames_are_stepped_through, timeline_is_dragged, image_is_zoomed_and_moved,
    grey_values_follow_the_right_button, five_frames_outlined_by_dragging, outline_set_point_by_point,
    last_points_removed_while_drawing, line_given_up, undone_to_nothing_and_redone_to_the_same_bytes,
    undone_after_saving_and_loading, points_moved_inserted_and_deleted, outline_pushed_with_the_brush, hole_is_subtracted,
    crossing_outline_is_refused_beside_it, absent_and_extremity_marks, second_structure_has_its_own_outlines,
    space_is_turned, dividing_plane_moves_hatching_and_volume, rulers_measure, reslice_planes_follow_their_handles,
    work_is_found_again_after_a_kill, live_sweep_is_recorded_and_reviewed, another_depth_ends_the_use_of_the_calibration,
    missing_source_is_a_message,
    light_and_larger, panes_are_resized_and_kept, help_page_shows_the_keys, saved_as_an_exam,
    faults_are_messages_and_the_exam_stays, no_display_is_a_clear_line, damaged_scripts_are_refused,
]

if __name__ == "__main__":
    sys.exit(run_all(SCENARIOS, sys.argv[1], Shared))
