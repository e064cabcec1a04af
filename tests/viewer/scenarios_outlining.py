"""Outlining by hand: drawing, mending, undoing, marks, several structures."""

import json

from viewer_driver import DUMP, IDLE, at, picture
from viewer_exams import draw, drawing, go_to, recording, structure


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


SCENARIOS = [
    five_frames_outlined_by_dragging, outline_set_point_by_point, last_points_removed_while_drawing, line_given_up,
    undone_to_nothing_and_redone_to_the_same_bytes, undone_after_saving_and_loading,
    points_moved_inserted_and_deleted, outline_pushed_with_the_brush, hole_is_subtracted,
    crossing_outline_is_refused_beside_it, absent_and_extremity_marks, second_structure_has_its_own_outlines,
]
