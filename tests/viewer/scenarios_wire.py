"""Outlining along edges by wire, and searches that are cancelled."""

import json
import random

from scenarios_assisted import Bladder, area, farthest, middle
from viewer_driver import DUMP, IDLE, at, picture
from viewer_exams import structure


def bladder_outlined_by_wire(viewer, shared):
    bladder = Bladder(viewer, shared)
    seeds = bladder.seeds(8, 6)
    click = lambda seed: {"click": at(*seed)}  # noqa: E731
    way = [{"move": at(*seeds[3])}, {"frames": 2}]
    beside = {"move": at(*middle(bladder.outlines[8]))}
    run = viewer.run(*bladder.recording(), events=[
        IDLE, *bladder.show(8), {"move": [3, 3]}, {"frames": 2}, picture("empty", "pane:Review"), {"key": "E"},
        {"move": at(*seeds[0])}, IDLE, *map(click, seeds[:3]),
        {"dump": "three.json"}, *way, {"dump": "ahead.json"}, picture("ahead", "pane:Review"), beside, {"frames": 2},
        {"dump": "aside.json"}, click(seeds[3]), {"key": "Ctrl+Z"}, *way, {"dump": "undone.json"},
        {"wait_s": 0.4}, *map(click, seeds[3:]), {"key": "Enter"}, IDLE, DUMP, picture(of="pane:Review"),
        {"key": "Ctrl+Z"}, IDLE,
        {"dump": "without.json"}])
    three, ahead, aside, undone = (run.state(name)["view"]["line"] for name in ("three", "ahead", "aside", "undone"))
    assert len(ahead) > len(three) + 5 and ahead != aside, "the line does not follow the pointer"
    assert farthest(ahead, bladder.outlines[8]) < 12, "the line does not follow the edge"
    assert undone == ahead, "taking back a click did not leave the line as it was before"
    assert run.picture("ahead").differs(run.picture("empty")) > 150, "the line is not shown"
    assert run.state("undone")["document"]["edits"] == 0
    (contour,) = structure(run.state())["contours"]
    assert contour["closed"] and contour["frame"] == 8 and run.state()["view"]["line"] == []
    assert abs(area(contour["points"]) / area(bladder.outlines[8]) - 1) < 0.05
    assert run.picture().differs(run.picture("empty")) > 300
    assert run.state("without")["document"]["structures"] == [], "the outline is not one action"


def wire_of_one_frame_becomes_no_outline_on_the_next(viewer, shared):
    bladder = Bladder(viewer, shared)
    clicks = [{"click": at(*seed)} for seed in bladder.seeds(8, 6)[:4]]
    ways = [[{"key": "Right"}, {"key": "Enter"}], [{"key": "Left"}, {"key": "Backspace"}, {"key": "Enter"}]]
    events = [IDLE, *bladder.show(8), {"key": "E"}, {"move": clicks[0]["click"]}, IDLE]
    for number, way in enumerate(ways):
        events += [*clicks, {"dump": f"line{number}.json"}, *way, IDLE, {"dump": f"left{number}.json"}, {"key": "Enter"},
                   *bladder.show(8)]
    run = viewer.run(*bladder.recording(), events=events)
    for number in range(len(ways)):
        assert len(run.state(f"line{number}")["view"]["line"]) > 10
        left = run.state(f"left{number}")
        assert left["view"]["frame"] != 8 and left["view"]["line"] == [] and left["document"]["edits"] == 0


def search_that_was_cancelled_begins_again(viewer, shared):
    random.seed(1)
    width, height = 1600, 1600
    image = bytearray(random.randbytes(width * height))
    for y in range(400, 1200):
        image[y * width + 400:y * width + 1200] = bytes(160 + v // 4 for v in image[y * width + 400:y * width + 1200])
    large = viewer.folder / "large.mha"
    large.write_bytes(
        b"ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False\n"
        b"DimSize = 1600 1600 1\nElementType = MET_UCHAR\nUltrasoundImageOrientation = MFA\n"
        b"Seq_Frame0000_Timestamp = 0\nSeq_Frame0000_ProbeToTrackerTransformStatus = OK\n"
        b"Seq_Frame0000_ProbeToTrackerTransform = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\nElementDataFile = LOCAL\n"
        + bytes(image))
    drawn = viewer.folder / "drawn.json"
    drawn.write_text(json.dumps({"fathom_contours": 1, "structures": [{"name": "box", "contours": [
        {"frame": 0, "closed": True, "points": [[404, 404], [1195, 404], [1195, 1195], [404, 1195]]}]}]}))
    wire = [{"click": at(600, 400)}, {"click": at(800, 400)}, {"click": at(1000, 400)}]
    run = viewer.run(large, "--contours", drawn, events=[
        IDLE, {"key": "J"}, {"click": "cancel:preview"}, IDLE, {"frames": 3}, {"dump": "refine.json"}, {"key": "Enter"},
        IDLE, {"frames": 2}, IDLE, {"dump": "refined.json"},
        {"key": "E"}, {"click": "cancel:edges"}, IDLE, {"frames": 3}, {"dump": "wire.json"}, wire[0], IDLE, *wire,
        {"frames": 2}, DUMP])
    assert run.state("refine")["view"]["preview"] == [] and run.state("refine")["jobs"] == []
    assert run.state("refined")["document"]["edits_done"] == 1, "Enter does not look again"
    assert run.state("wire")["jobs"] == [] and len(run.state()["view"]["line"]) > 100, "a click does not look again"


def wire_taken_back_to_where_it_is_clicked(viewer, shared):
    bladder = Bladder(viewer, shared)
    seeds = bladder.seeds(8, 6)
    clicks = [{"click": at(*seed)} for seed in seeds[:4]]
    back = bladder.seeds(8, 12)[3]  # half way between the second and the third click, on the line
    run = viewer.run(*bladder.recording(), events=[
        IDLE, *bladder.show(8), {"move": [3, 3]}, {"frames": 2}, picture("empty", "pane:Review"), {"key": "E"},
        {"move": at(*seeds[0])}, IDLE, *clicks,
        {"dump": "far.json"}, {"click": at(*back)}, {"dump": "back.json"}, {"key": "Backspace"},
        {"move": at(*seeds[3])},
        {"frames": 2}, {"dump": "again.json"}, {"key": "Escape"}, {"move": [3, 3]}, {"frames": 2},
        {"dump": "none.json"},
        picture("none", "pane:Review"), {"move": at(*seeds[2])}, {"frames": 2}, {"dump": "later.json"},
        {"key": "B"}, {"key": "E"}, {"move": at(*seeds[1])}, {"frames": 2}, DUMP])
    far, taken, again = (run.state(name)["view"]["line"] for name in ("far", "back", "again"))
    assert len(far) * 0.35 < len(taken) < len(far) * 0.65, (len(far), len(taken))
    assert taken == far[:len(taken)] or farthest(taken, far) < 2
    assert farthest(again, far) < 2 and abs(len(again) - len(far)) < 5, "taking it back cannot be undone"
    for name in ("none", "later", "state"):
        state = run.state(name)
        assert state["view"]["line"] == [] and state["document"]["edits"] == 0, f"{name}: Escape left something behind"
    assert run.picture("none").differs(run.picture("empty")) == 0


SCENARIOS = [
    bladder_outlined_by_wire, wire_of_one_frame_becomes_no_outline_on_the_next, wire_taken_back_to_where_it_is_clicked,
    search_that_was_cancelled_begins_again,
]
