"""Outlining with help of the image: region, threshold, refinement, filling between outlines."""

import json

from viewer_driver import DUMP, IDLE, at, picture
from viewer_exams import fathom, go_to, is_bright_cyan, recording, structure


def area(points):
    return abs(sum(p[0] * q[1] - q[0] * p[1] for p, q in zip(points, points[1:] + points[:1]))) / 2


def middle(points):
    return [sum(p[i] for p in points) / len(points) for i in range(2)]


def farthest(points, others):
    """How far the point of the one that is farthest from all points of the other lies from them."""
    return max(min((p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 for q in others) for p in points) ** 0.5


def is_white(r, g, b):
    return r == g == b and r > 225


class Bladder:
    """A speckled sweep of a bladder, with the true outlines."""

    FRAMES = 16

    def __init__(self, viewer, shared):
        self.program, self.folder, self.scan = shared.program, viewer.folder, viewer.folder / "bladder.mha"
        fathom(shared.program, "simulate", "--object", "bladder", "--pattern", "free", "--frames", self.FRAMES,
               "--speckle", "--out", self.scan)
        self.calibration = viewer.folder / "bladder.calibration.json"
        contours = json.loads((viewer.folder / "bladder.contours.json").read_text())["structures"][0]["contours"]
        self.outlines = {c["frame"]: c["points"] for c in contours if "points" in c}

    def recording(self):
        return [self.scan, "--calibration", self.calibration]

    def show(self, frame):
        return [{"click": {"item": "pane:Timeline", "at": [(frame + 0.5) / self.FRAMES, 0.7]}}, IDLE]

    def seeds(self, frame, count):
        points = self.outlines[frame]
        return [points[i * len(points) // count] for i in range(count)]

    def with_outlines(self, outlines):
        contours = self.folder / "drawn.json"
        contours.write_text(json.dumps({"fathom_contours": 1, "structures": [
            {"name": "bladder", "color": "#33ccff",
             "contours": [{"frame": f, "closed": True, "points": points} for f, points in outlines.items()]}]}))
        return [*self.recording(), "--contours", contours]


def region_grows_from_seeds(viewer, shared):
    truth = shared.outlines[5]
    inside = middle(truth)
    run = viewer.run(*recording(shared), events=[
        IDLE, *go_to(5), {"move": [3, 3]}, {"frames": 2}, picture("empty", "pane:Review"), {"click": "Region"},
        {"click": at(*inside)}, IDLE, {"move": [3, 3]},
        {"frames": 2}, {"dump": "shown.json"}, picture("shown", "pane:Review"), {"key": "Ctrl+Z"}, IDLE,
        {"dump": "back.json"},
        {"click": at(*inside)}, IDLE, {"key": "Escape"}, {"move": [3, 3]}, {"frames": 2}, {"dump": "dropped.json"},
        picture("dropped", "pane:Review"), {"click": at(*inside)}, {"key": "Enter"}, IDLE, {"move": [3, 3]},
        {"frames": 2}, DUMP,
        picture(of="pane:Review"), {"key": "Ctrl+Z"}, IDLE, {"dump": "undone.json"}, picture("undone", "pane:Review")])
    shown = run.state("shown")["view"]
    assert len(shown["preview"]) == 1 and len(shown["seeds"]) == 1
    assert abs(area(shown["preview"][0]) / area(truth) - 1) < 0.02
    assert run.picture("shown").differs(run.picture("empty")) > 100
    for name in ("back", "dropped", "undone"):
        state = run.state(name)
        assert state["view"]["preview"] == state["view"]["seeds"] == state["document"]["structures"] == [], name
    assert run.picture("dropped").differs(run.picture("empty")) == 0 == run.picture("undone").differs(run.picture("empty"))
    contours = structure(run.state())["contours"]
    assert [c["points"] for c in contours] == shown["preview"] and contours[0]["frame"] == 5
    assert run.state()["view"]["preview"] == [] and run.picture().differs(run.picture("empty")) > 100


def region_taken_again_replaces_what_it_covers(viewer, shared):
    truth, inside = shared.outlines[5], middle(shared.outlines[5])
    small = [[inside[i] + (p[i] - inside[i]) * 0.6 for i in range(2)] for p in truth[::8]]
    apart = [[20, 20], [40, 20], [40, 40], [20, 40]]
    drawn = viewer.folder / "drawn.json"
    drawn.write_text(json.dumps({"fathom_contours": 1, "structures": [{"name": "bladder", "contours": [
        {"frame": f, "closed": True, "points": points} for f, points in ((4, small), (5, small), (5, apart))]}]}))
    take = [{"click": at(*inside)}, IDLE, {"click": "Take"}, IDLE]
    wider = {"drag": [{"item": "tolerance", "at": [0.3, 0.5]}, {"item": "tolerance", "at": [0.8, 0.5]}]}
    run = viewer.run(*recording(shared), "--contours", drawn, events=[
        IDLE, *go_to(5), {"click": "Region"}, *take, {"dump": "once.json"}, wider, *take, DUMP, {"key": "Ctrl+Z"},
        {"key": "Ctrl+Z"}, IDLE, {"dump": "undone.json"}])
    for name in ("once", "state"):
        here = [c["points"] for c in structure(run.state(name))["contours"] if c["frame"] == 5]
        assert len(here) == 2 and apart in here, f"{name}: {len(here)} outlines"
        (taken,) = [points for points in here if points != apart]
        assert abs(area(taken) / area(truth) - 1) < 0.02, name
        assert small in [c["points"] for c in structure(run.state(name))["contours"] if c["frame"] == 4]
    assert len(structure(run.state("undone"))["contours"]) == 3


def region_without_a_border_is_a_message(viewer, shared):
    run = viewer.run(*recording(shared), events=[
        IDLE, *go_to(0), {"key": "K"}, {"click": at(30, 30)}, IDLE, {"key": "Enter"}, IDLE, DUMP,
        picture(of="pane:Messages")])
    state = run.state()
    assert state["document"]["edits"] == 0 and state["view"]["preview"] == []
    assert [m["about"] for m in state["messages"]] == ["region"] and "border" in state["messages"][0]["text"]
    assert run.picture().count(lambda r, g, b: r > 180 and g < 140) > 50


def threshold_follows_its_sliders(viewer, shared):
    truth = shared.outlines[5]
    outside = [truth[0][0] + 500, truth[0][1]]
    run = viewer.run(*recording(shared), events=[
        IDLE, *go_to(5), {"key": "I"}, IDLE, {"dump": "bright.json"}, picture("bright", "pane:Review"),
        {"drag": [{"item": "high", "at": [0.9, 0.5]}, {"item": "high", "at": [0.4, 0.5]}]},
        {"drag": [{"item": "low", "at": [0.3, 0.5]}, {"item": "low", "at": [0.0, 0.5]}]}, IDLE, {"dump": "dark.json"},
        {"key": "Escape"}, {"frames": 2}, {"dump": "dropped.json"}, {"key": "Enter"}, IDLE, {"dump": "nothing.json"},
        {"drag": [{"item": "high", "at": [0.4, 0.5]}, {"item": "high", "at": [1.0, 0.5]}]},
        {"drag": [{"item": "low", "at": [0.02, 0.5]}, {"item": "low", "at": [0.5, 0.5]}]}, IDLE,
        {"click": at(*middle(truth))}, IDLE, {"dump": "part.json"}, {"click": "Take"}, IDLE, DUMP, {"key": "Ctrl+Z"},
        IDLE,
        {"dump": "undone.json"}])
    bright, dark = run.state("bright")["view"]["preview"], run.state("dark")["view"]["preview"]
    assert len(bright) == 1 and abs(area(bright[0]) / area(truth) - 1) < 0.02
    assert len(dark) == 2 and abs(area(dark[1]) / area(truth) - 1) < 0.03, "the dark part has the bright one as a hole"
    assert outside not in dark[0] and run.picture("bright").count(is_white) > 100
    for name in ("dropped", "nothing", "undone"):
        assert run.state(name)["view"]["preview"] == run.state(name)["document"]["structures"] == [], name
    part = run.state("part")["view"]
    assert len(part["preview"]) == len(part["seeds"]) == 1
    assert [c["points"] for c in structure(run.state())["contours"]] == part["preview"]
    assert run.state()["document"]["edits_done"] == 1


def threshold_at_its_ends_has_no_limits(viewer, shared):
    """16 bits: the frame that is shown first is darker than the other, of which all bright values must be taken."""
    square = lambda value: b"".join(  # noqa: E731
        (value if 50 <= x < 110 and 40 <= y < 90 else 100).to_bytes(2, "little") for y in range(120) for x in range(160))
    fields = "".join(
        f"Seq_Frame000{i}_Timestamp = {i}\nSeq_Frame000{i}_ProbeToTrackerTransformStatus = OK\n"
        f"Seq_Frame000{i}_ProbeToTrackerTransform = 1 0 0 0 0 1 0 0 0 0 1 {i} 0 0 0 1\n" for i in range(2))
    dark = viewer.folder / "dark.mha"
    dark.write_bytes(
        b"ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False\n"
        b"DimSize = 160 120 2\nElementType = MET_USHORT\nUltrasoundImageOrientation = MFA\n"
        + fields.encode() + b"ElementDataFile = LOCAL\n" + square(2500) + square(1000))
    truth = shared.outlines[5]
    run = viewer.run(dark, events=[
        IDLE, {"key": "I"}, IDLE, {"dump": "first.json"}, {"key": "Left"}, IDLE, {"dump": "bright.json"},
        {"drag": [{"item": "low", "at": [0.5, 0.5]}, {"item": "low", "at": [0.0, 0.5]}]}, IDLE, {"dump": "all.json"},
        {"drop": str(shared.scan)}, IDLE, *go_to(5), {"key": "I"}, IDLE, DUMP])
    assert run.state("first")["view"]["frame"] == 1 and run.state("bright")["view"]["frame"] == 0
    for name, wanted_px in (("first", 60 * 50), ("bright", 60 * 50), ("all", 160 * 120)):
        areas = [area(outline) for outline in run.state(name)["view"]["preview"]]
        assert len(areas) == 1 and abs(areas[0] / wanted_px - 1) < 0.15, f"{name}: {areas}"
    (found,) = run.state()["view"]["preview"]
    assert abs(area(found) / area(truth) - 1) < 0.02, "the limits are those of the recording that was open before"


def outline_is_refined(viewer, shared):
    bladder = Bladder(viewer, shared)
    truth = bladder.outlines[8]
    centre = middle(truth)
    drawn = [[centre[i] + (p[i] - centre[i]) * 0.94 for i in range(2)] for p in truth[::8]]
    run = viewer.run(*bladder.with_outlines({8: drawn, 5: bladder.outlines[5][::8]}), events=[
        IDLE, *bladder.show(8), {"move": [3, 3]}, {"frames": 2}, picture("before", "pane:Review"), {"key": "J"}, IDLE,
        {"frames": 2}, {"dump": "shown.json"},
        picture("shown", "pane:Review"), {"key": "Escape"}, {"frames": 2}, {"dump": "dropped.json"}, {"key": "J"}, IDLE,
        {"drag": [{"item": "reach", "at": [0.2, 0.5]}, {"item": "reach", "at": [0.5, 0.5]}]}, IDLE,
        {"dump": "farther.json"},
        {"key": "Enter"}, IDLE, DUMP, {"key": "Ctrl+Z"}, IDLE, {"dump": "undone.json"}])
    shown, farther = run.state("shown")["view"]["preview"], run.state("farther")["view"]["preview"]
    assert len(shown) == len(farther) == 1 and shown != farther, "the reach changes nothing"
    off = lambda points: abs(area(points) / area(truth) - 1)  # noqa: E731
    assert off(drawn) > 0.1 and off(shown[0]) < off(drawn) and off(farther[0]) < 0.04, (off(shown[0]), off(farther[0]))
    assert run.picture("shown").differs(run.picture("before")) > 100
    assert run.state("dropped")["view"]["preview"] == [] and run.state("dropped")["document"]["edits"] == 0
    by_frame = {c["frame"]: c["points"] for c in structure(run.state())["contours"]}
    assert by_frame[8] == farther[0] and len(by_frame) == 2 and run.state()["view"]["preview"] == []
    undone = {c["frame"]: c["points"] for c in structure(run.state("undone"))["contours"]}
    assert undone[5] == by_frame[5] and undone[8] == drawn


def outline_is_not_refined_beyond_another_structure(viewer, shared):
    bladder = Bladder(viewer, shared)
    truth = bladder.outlines[8]
    centre = middle(truth)
    drawn = [[centre[i] + (p[i] - centre[i]) * 0.96 for i in range(2)] for p in truth[::8]]
    side = max(x for x, _ in drawn) + 2
    box = [[side, centre[1] - 60], [side + 60, centre[1] - 60], [side + 60, centre[1] + 60], [side, centre[1] + 60]]
    alone = bladder.with_outlines({8: drawn})
    both = json.loads(alone[-1].read_text())
    both["structures"].append({"name": "stone", "contours": [{"frame": 8, "closed": True, "points": box}]})
    with_box = viewer.folder / "both.json"
    with_box.write_text(json.dumps(both))
    right = []
    for contours in (alone[-1], with_box):
        run = viewer.run(*alone[:-1], contours, events=[IDLE, *bladder.show(8), {"key": "J"}, IDLE, DUMP])
        (found,) = run.state()["view"]["preview"]
        right.append(max(x for x, _ in found))
    assert right[0] > side + 0.5 and right[1] < side, (right, side)


def filled_between_outlines(viewer, shared):
    bladder = Bladder(viewer, shared)
    drawn = {f: bladder.outlines[f][::8] for f in (2, 7, 13)}
    run = viewer.run(*bladder.with_outlines(drawn), events=[
        IDLE, *bladder.show(5), {"move": [3, 3]}, {"frames": 2}, picture("before", "pane:Review"), {"key": "T"},
        {"click": "cancel:fill"}, IDLE,
        {"dump": "cancelled.json"}, {"key": "T"}, IDLE, {"frames": 2}, DUMP, picture(of="pane:Review"),
        {"key": "Ctrl+Z"},
        IDLE, {"dump": "undone.json"}, picture("undone", "pane:Review")])
    filled = {c["frame"]: c for c in structure(run.state())["contours"]}
    assert sorted(filled) == list(range(2, 14)) and run.state()["document"]["edits_done"] == 1
    assert all((filled[f]["confidence"] is None) == (f in drawn) for f in filled)
    off = {f: abs(area(filled[f]["points"]) / area(bladder.outlines[f]) - 1) for f in filled}
    assert max(off.values()) < 0.15, off
    assert run.picture().count(is_bright_cyan) > run.picture("before").count(is_bright_cyan) + 100
    assert run.picture("undone").differs(run.picture("before")) == 0
    for name in ("cancelled", "undone"):
        assert sorted(c["frame"] for c in structure(run.state(name))["contours"]) == sorted(drawn), name


def unsure_outlines_are_shown_and_mended(viewer, shared):
    frames = {f: shared.loop(f, 16) for f in shared.frames[1:8]}
    sure, unsure = shared.frames[3], shared.frames[5]
    contours = [{"frame": f, "closed": True, "points": points} for f, points in frames.items()]
    for contour in contours:
        contour.update({sure: {"confidence": 0.97}, unsure: {"confidence": 0.6}}.get(contour["frame"], {}))
    path = viewer.folder / "filled.json"
    path.write_text(json.dumps({"fathom_contours": 1, "structures": [
        {"name": "bladder", "color": "#33ccff", "contours": contours}]}))
    start = frames[unsure][0]
    run = viewer.run(*recording(shared), "--contours", path, events=[
        IDLE, {"key": "Home"}, *go_to(sure), {"frames": 2}, picture("sure", "pane:Review"), {"key": "Home"},
        {"key": "Shift+Right"},
        IDLE, {"frames": 2}, {"dump": "shown.json"}, picture("unsure", "pane:Review"),
        picture("line", "pane:Timeline"), {"key": "P"},
        {"drag": [at(*start), at(start[0] + 8, start[1] + 8)]}, {"key": "B"}, {"move": [3, 3]}, IDLE, {"frames": 2},
        DUMP,
        picture(of="pane:Review"), picture("mended", "pane:Timeline"), {"key": "Ctrl+Z"}, IDLE,
        {"dump": "undone.json"}])
    confidences = lambda name: {c["frame"]: c["confidence"] for c in structure(run.state(name))["contours"]}  # noqa: E731
    assert run.state("shown")["view"]["frame"] == unsure and confidences("shown")[unsure] == 0.6
    dashed, full = (run.picture(name).count(is_bright_cyan) for name in ("unsure", "picture"))
    assert dashed < 0.8 * full, "an unsure outline looks like a sure one"
    orange = lambda r, g, b: r > 220 and 100 < g < 140 and b < 60  # noqa: E731
    assert run.picture("line").count(orange) > 20 and run.picture("mended").count(orange) == 0
    assert confidences("state")[unsure] is None and confidences("state")[sure] == 0.97, "a mended outline is the user's own"
    assert confidences("undone") == confidences("shown")


SCENARIOS = [
    region_grows_from_seeds, region_taken_again_replaces_what_it_covers, region_without_a_border_is_a_message,
    threshold_follows_its_sliders, threshold_at_its_ends_has_no_limits, outline_is_refined,
    outline_is_not_refined_beyond_another_structure, filled_between_outlines, unsure_outlines_are_shown_and_mended,
]
