"""Space, surfaces, dividing planes, rulers, reslices."""

import json

from viewer_driver import DUMP, IDLE, at, picture
from viewer_exams import fathom, is_hatching, recording, structure


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


def surface_cancelled_in_mid_work(viewer, shared):
    long = viewer.folder / "long.mha"  # so many outlines that the surface takes longer than a click
    fathom(shared.program, "simulate", "--object", "kidney", "--pattern", "free", "--frames", 700, "--out", long)
    outlines = json.loads((viewer.folder / "long.contours.json").read_text())["structures"][0]["contours"]
    outlines = [{**outline, "points": outline["points"][::8]} for outline in outlines if "points" in outline]
    contours = viewer.folder / "kidney.json"
    contours.write_text(json.dumps({"fathom_contours": 1, "structures": [
        {"name": "kidney", "color": "#33ccff", "contours": outlines}]}))
    cancel = [{"click": "cancel:surface 1"}, IDLE]
    edit = [{"key": "Shift+Delete"}, {"key": "Ctrl+Z"}]  # while one is made another waits, and Cancel is for both
    # Without Outline, since drawing that many outlines without a graphics card takes as long as the surface.
    run = viewer.run(long, "--calibration", viewer.folder / "long.calibration.json", "--contours", contours, events=[
        {"frames": 1}, {"key": "F5"}, *cancel, {"dump": "opened.json"}, *edit, *cancel, {"dump": "edited.json"},
        {"key": "F5"}, {"key": "G"}, {"key": "O"}, {"frames": 3}, picture("bare", "pane:Outline"),
        picture("said", "pane:Measurements"), {"click": "Make the surface"}, IDLE, {"frames": 2}, DUMP,
        picture("made", "pane:Outline")])
    for name in ("opened", "edited"):
        stopped = structure(run.state(name))
        assert stopped["triangles"] == 0 and stopped["surface_ml"] is None and stopped["surface_cancelled"], name
        assert stopped["volume_ml"] > 1 and run.state(name)["jobs"] == [], "planimetry needs no surface"
        assert [c["points"] for c in stopped["contours"]] == [c["points"] for c in outlines], "the exam has changed"
    made = structure(run.state())
    assert made["triangles"] > 500 and abs(made["surface_ml"] / made["volume_ml"] - 1) < 0.05
    assert not made["surface_cancelled"] and run.picture("made").differs(run.picture("bare")) > 300
    assert run.state()["document"]["contours_text"] == run.state("opened")["document"]["contours_text"]
    orange = lambda r, g, b: r > 200 and 120 < g < 200 and b < 110  # noqa: E731
    assert run.picture("said").count(orange) > 100, "nothing is said"


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


SCENARIOS = [
    space_is_turned, surface_cancelled_in_mid_work, dividing_plane_moves_hatching_and_volume, rulers_measure, reslice_planes_follow_their_handles,
]
