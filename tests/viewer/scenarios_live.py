"""Recording from devices."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "cli"))
from unplugged_devices import deeper_recording  # noqa: E402
from viewer_driver import DUMP, IDLE, picture  # noqa: E402


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


SCENARIOS = [
    live_sweep_is_recorded_and_reviewed, another_depth_ends_the_use_of_the_calibration, missing_source_is_a_message,
]
