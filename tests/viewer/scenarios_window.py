"""The window and the safety of work in it."""

import json
import time

from viewer_driver import DUMP, IDLE, picture
from viewer_exams import drawing, recording, structure


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


def first_steps_lead_to_a_calibrated_recording(viewer, shared):
    begin = viewer.run(events=[{"frames": 3}, picture("empty"), {"click": "welcome:Live"}, {"frames": 3}, DUMP,
                               picture("live"), {"key": "F4"}, {"frames": 2}, {"click": "welcome:Keys and mouse"},
                               {"frames": 3}, picture("keys", "pane:Help")])
    assert begin.picture("live").differs(begin.picture("empty")) > 2000 and begin.picture("keys").width > 300
    run = viewer.run(shared.scan, events=[IDLE, {"dump": "bare.json"}, picture("bare", "pane:Review"),
                                          {"click": "Use the calibration beside"}, IDLE, DUMP,
                                          picture("space", "pane:Outline")])
    assert not run.state("bare")["document"]["calibrated"] and run.state()["document"]["calibrated"]
    assert run.picture("space").count(lambda r, g, b: r > 100) > 100, "no frames in space"
    again = viewer.run(events=[{"frames": 3}, {"click": f"recent:{shared.scan}"}, IDLE, DUMP])
    assert again.state()["view"]["frames"] == 12


SCENARIOS = [
    light_and_larger, panes_are_resized_and_kept, help_page_shows_the_keys, first_steps_lead_to_a_calibrated_recording,
    saved_as_an_exam, work_is_found_again_after_a_kill,
]
