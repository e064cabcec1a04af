"""Looking at exams and recordings."""

import json
from pathlib import Path

from viewer_driver import DUMP, IDLE, at, picture
from viewer_exams import drawing, fathom, is_bright_cyan, recording, structure


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


SCENARIOS = [
    exam_is_shown, recording_without_calibration_has_no_volume, dropped_calibration_gives_the_volume,
    dropped_exam_is_opened, frames_are_stepped_through, timeline_is_dragged, image_is_zoomed_and_moved,
    grey_values_follow_the_right_button, real_spine_sweep_is_opened,
]
