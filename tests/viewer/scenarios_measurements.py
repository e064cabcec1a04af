"""What the viewer tells of volumes and makes of them, by mouse and keys on the real window: intervals, where to outline
next, missing ends, opacity, pictures of panes, simulated sources."""

import json
import shutil
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent.parent / "docs"))
from small_png import decode  # noqa: E402
from viewer_driver import DUMP, IDLE, at, picture  # noqa: E402
from viewer_exams import draw, fathom, go_to, structure  # noqa: E402

PANE = "pane:Measurements"
WINDOW = (1000, 760)


def measured(shared, exam):
    """What `fathom measure` says of an exam's structure."""
    return json.loads(fathom(shared.program, "measure", exam, "--json"))["structures"][0]


# Intervals.

def interval_and_missing_ends_are_those_of_measure(viewer, shared):
    exam = shared.exam(viewer.folder)
    run = viewer.run(exam, window=WINDOW, events=[IDLE, DUMP, picture(of=PANE), {"click": "missing end 2"}, IDLE,
                                                  {"dump": "end.json"}])
    shown, expected = structure(run.state()), measured(shared, exam)
    assert expected["recommended"] == "cubic_planimetry_quadric"
    assert abs(shown["volume_ml"] - expected["volume_ml"][expected["recommended"]]) < 1e-9
    for key in ("volume_interval_ml", "where_next", "missing_ends"):
        assert shown[key] == expected[key], key
    low, high = shown["volume_interval_ml"]
    assert low < shown["volume_ml"] < high
    # The outer frames of the ellipsoid are not outlined: both ends are missing, and not in the volume.
    assert len(shown["missing_ends"]) == 2 and shown["missing_ends"][1]["volume_ml"] > 0
    truth = json.loads((shared.scan.parent / "scan.truth.json").read_text())["volume_ml"]
    assert shown["volume_ml"] < truth
    assert run.state("end")["view"]["frame"] == shown["missing_ends"][1]["frame"]


def click_on_outline_next_goes_to_the_frame_and_outlining_it_gains(viewer, shared):
    exam = viewer.folder / "sparse"
    sparse = viewer.folder / "sparse.json"
    frames = [shared.frames[i] for i in (0, 3, 6, 9)]
    sparse.write_text(json.dumps({"fathom_contours": 1, "structures": [
        {"name": "bladder", "contours": [{"frame": f, "closed": True, "points": shared.loop(f, 40)} for f in frames]}]}))
    fathom(shared.program, "exam", "create", exam, "--recording", shared.scan, "--calibration", shared.calibration,
           "--contours", sparse)
    suggested = measured(shared, exam)["where_next"]
    run = viewer.run(exam, window=WINDOW, events=[
        IDLE, {"dump": "before.json"}, {"click": "outline next"}, IDLE, {"dump": "there.json"}, {"click": "Draw"},
        draw(shared.loop(suggested["frame"], 40)), IDLE, DUMP])
    before, after = structure(run.state("before")), structure(run.state())
    assert run.state("there")["view"]["frame"] == suggested["frame"] == before["where_next"]["frame"]
    assert suggested["frame"] not in frames and suggested["gain_ml"] > 0
    assert after["where_next"]["uncertain_ml"] < before["where_next"]["uncertain_ml"]


def interval_is_not_shown_while_an_outline_moves(viewer, shared):
    exam = shared.exam(viewer.folder)
    frame = shared.frames[4]
    point = shared.loop(frame, 16)[0]
    run = viewer.run(exam, window=WINDOW, events=[
        IDLE, *go_to(frame), {"click": "Points"}, DUMP, {"move": at(*point)}, {"press": 0},
        {"move": at(point[0] + 6, point[1] + 4)}, {"frames": 3}, {"dump": "held.json"}, {"release": 0}, IDLE,
        {"dump": "done.json"}])
    before, held, done = (structure(run.state(name)) for name in ("state", "held", "done"))
    assert held["volume_ml"] != before["volume_ml"], "the volume follows the drag"
    assert "volume_interval_ml" not in held, "of another volume than the one shown"
    assert done["volume_interval_ml"] != before["volume_interval_ml"]


def too_few_sections_have_no_interval(viewer, shared):
    run = viewer.run(shared.scan, "--calibration", shared.calibration, window=WINDOW, events=[
        IDLE, {"click": "Draw"}, *[e for f in shared.frames[2:5] for e in go_to(f) + [draw(shared.loop(f, 40))]], IDLE,
        DUMP])
    assert structure(run.state())["volume_ml"] > 0.3
    assert structure(run.state())["volume_interval_ml"] is None


def several_sweeps_have_one_interval_between_planes(viewer, shared):
    run = viewer.run(shared.pair, "--calibration", shared.pair_calibration, "--contours", shared.pair_contours,
                     window=WINDOW, events=[
                         IDLE, {"key": "F6"}, {"frames": 2}, {"click": "Dividing planes"}, {"frames": 2},
                         {"click": "Place planes"}, IDLE, DUMP])
    low, high = structure(run.state())["volume_interval_ml"]
    assert 0.3 < low < structure(run.state())["volume_ml"] < high
    assert structure(run.state())["where_next"] is None


# How surfaces look.

def opacity_dragged_while_saving_is_two_actions(viewer, shared):
    to = lambda share: {"move": {"item": "opacity 1", "at": [share, 0.5]}}  # noqa: E731
    run = viewer.run(shared.exam(viewer.folder), window=WINDOW, events=[
        IDLE, {"dump": "before.json"}, to(0.5), {"press": 0}, {"frames": 2}, to(0.6), {"frames": 2}, {"key": "Ctrl+S"},
        *[event for share in (0.7, 0.75, 0.8, 0.85, 1.5) for event in (to(share), {"frames": 2})], {"release": 0}, IDLE,
        DUMP])
    before, after = run.state("before")["document"], run.state()["document"]
    assert after["structures"][0]["opacity"] == 1.0
    assert after["edits_done"] == before["edits_done"] + 2, after["edits_done"]


def opacity_is_dragged_undone_and_kept(viewer, shared):
    exam = shared.exam(viewer.folder)
    space = "pane:Outline"
    run = viewer.run(exam, window=WINDOW, events=[
        IDLE, {"dump": "before.json"}, picture("before", space),
        {"drag": [{"item": "opacity 1", "at": [0.5, 0.5]}, {"item": "opacity 1", "at": [0.8, 0.5]},
                  {"item": "opacity 1", "at": [1.5, 0.5]}]}, IDLE, {"dump": "solid.json"}, picture("solid", space),
        {"drag": [{"item": "opacity 1", "at": [0.9, 0.5]}, {"item": "opacity 1", "at": [-0.5, 0.5]}]}, IDLE,
        {"dump": "none.json"}, picture("none", space), {"key": "Ctrl+Z"}, IDLE, {"dump": "undone.json"},
        picture("undone", space), {"key": "Ctrl+S"}, IDLE])
    states = {name: run.state(name)["document"] for name in ("before", "solid", "none", "undone")}
    opacities = {name: state["structures"][0]["opacity"] for name, state in states.items()}
    assert opacities == {"before": 0.55, "solid": 1.0, "none": 0.0, "undone": 1.0}, opacities
    assert states["solid"]["edits_done"] == states["before"]["edits_done"] + 1, "a drag is one action"
    for name in ("solid", "none"):
        assert states[name]["structures"][0]["volume_ml"] == states["before"]["structures"][0]["volume_ml"]
    # The outlines inside shine through the half-transparent surface, and stand alone without it.
    cyan = {name: run.picture(name).count(lambda r, g, b: b > r + 30 and g > r + 20) for name in states}
    assert cyan["none"] < 0.7 * cyan["before"], cyan
    assert run.picture("solid").differs(run.picture("before")) > 1000
    assert run.picture("undone").differs(run.picture("solid")) == 0
    again = viewer.run(exam, window=WINDOW, events=[IDLE, DUMP])
    assert structure(again.state())["opacity"] == 1.0, "kept with the exam"


# Pictures.

def png_size(path):
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    return int.from_bytes(data[16:20], "big"), int.from_bytes(data[20:24], "big")


def ask_for_picture(file, pane=None, without_names=False, area=None):
    events = [{"menu": "File/Picture..."}, {"frames": 2}]
    if pane:
        events += [{"click": "picture of"}, {"frames": 2}, {"click": f"picture of:{pane}"}, {"frames": 2}]
    if without_names:
        events += [{"click": "Without names"}, {"frames": 2}]
    if area:
        events += [{"click": "picture area"}, {"key": "Ctrl+A"}, {"text": area}]
    return events + [{"click": "Choose a file..."}, {"frames": 2}, {"click": "Name"}, {"key": "Ctrl+A"},
                     {"text": str(file)}, {"click": "Write"}, IDLE, {"frames": 2}]


def picture_of_a_pane_is_written(viewer, shared):
    files = [viewer.folder / name for name in ("space.png", "window.png", "wrong.jpg")]
    run = viewer.run(shared.exam(viewer.folder), window=WINDOW, events=[
        IDLE, picture("expected", "pane:Outline"), *ask_for_picture(files[0], "Outline"), *ask_for_picture(files[1], "Window"),
        {"dump": "written.json"}, *ask_for_picture(files[0], "Review"), *ask_for_picture(files[2]), DUMP])
    expected = run.picture("expected")
    width, height, pixels = decode(files[0].read_bytes())
    assert (width, height) == (expected.width, expected.height) and pixels == expected.pixels
    assert png_size(files[1]) == WINDOW
    assert sum("written to" in m["text"] for m in run.state("written")["messages"]) == 2
    texts = [m["text"] for m in run.state()["messages"] if m["is_error"]]
    assert any("is there already" in t for t in texts) and any("name it .png" in t for t in texts), texts
    assert not files[2].exists() and png_size(files[0]) == (width, height)


def picture_without_names_shows_only_what_is_free_of_them(viewer, shared):
    window = (860, 620)  # every pixel is looked at
    exam = shared.exam(viewer.folder)
    files = [viewer.folder / f"{name}.png" for name in ("whole", "part", "nothing", "window")]
    part = (130, 180, 60, 60)
    run = viewer.run(exam, window=window, events=[
        IDLE, {"key": "O"}, {"wheel": -40, "at": PANE}, {"frames": 3}, {"click": "Exam"}, {"frames": 3},
        {"wheel": -40, "at": PANE}, {"frames": 3}, {"click": "Patient"}, {"text": "Smith"}, {"click": "Add structure"}, IDLE, DUMP,
        *ask_for_picture(files[0], "Review"), *ask_for_picture(files[1], "Review", True, " ".join(map(str, part))),
        *ask_for_picture(files[2], "Review", False, "  "), *ask_for_picture(files[3], "Window"), {"dump": "after.json"}])
    white = {}
    for file in files[:3]:
        width, height, pixels = decode(file.read_bytes())
        white[file.stem] = sum(1 for i in range(0, len(pixels), 3) if pixels[i:i + 3] == b"\xff\xff\xff")
    assert 0 < white["part"] < 0.6 * white["whole"], white
    assert white["nothing"] == 0, "no part was named: no B-scan is shown"
    assert run.state("after")["document"]["texts"][0] == "Smith"
    # The line with the exam's name, and its texts, are empty, as is the reslice pane but for its lines.
    width, height, pixels = decode(files[3].read_bytes())
    status = pixels[3 * width * (height - 12):3 * width * (height - 11)]
    assert len({status[i:i + 3] for i in range(0, len(status), 3)}) == 1, "the exam's name is shown"
    # Without a calibration, and where nothing is open: pictures are the same whatever files are called.
    pictures = []
    for name in ("smith", "eleanor-rigby"):
        scan = viewer.folder / f"{name}.mha"
        shutil.copy(shared.scan, scan)
        shutil.copy(shared.calibration, scan.with_suffix(".calibration.json"))
        files = [viewer.folder / f"{name}-{what}.png" for what in ("opened", "closed")]
        viewer.run(scan, window=window, events=[
            IDLE, {"frames": 3}, *ask_for_picture(files[0], "Window", True), {"key": "Ctrl+W"}, IDLE, {"frames": 3},
            *ask_for_picture(files[1], "Window")])
        pictures.append([decode(file.read_bytes()) for file in files])
    for what in range(2):
        assert pictures[0][what] == pictures[1][what], "the picture tells a file's name"


# Live.

def simulated_source_is_listed_and_recorded(viewer, shared):
    target = viewer.folder / "sweep"
    run = viewer.run(window=WINDOW, events=[
        {"frames": 3}, {"key": "F4"}, IDLE, {"frames": 3}, {"click": "device:sim:bladder/linear"}, {"frames": 2},
        {"click": "Connect"}, {"wait_s": 1.0}, {"dump": "live.json"}, picture("live"),
        {"click": "recording folder"}, {"key": "Ctrl+A"}, {"text": str(target)}, {"click": "Record"}, {"wait_s": 1.0},
        {"click": "End"}, IDLE, {"frames": 3}, DUMP])
    live = run.state("live")["live"]
    assert live["connected"] and live["received"] > 3 and live["transforms"] == 2, live
    assert run.picture("live").count(lambda r, g, b: r == g == b and r > 100) > 500, "the image is not shown"
    assert run.state()["live"]["verdict"]["frames"] > 5 and (target / "sweep.mhd").exists()


SCENARIOS = [
    interval_and_missing_ends_are_those_of_measure, click_on_outline_next_goes_to_the_frame_and_outlining_it_gains,
    interval_is_not_shown_while_an_outline_moves, too_few_sections_have_no_interval,
    several_sweeps_have_one_interval_between_planes, opacity_dragged_while_saving_is_two_actions,
    opacity_is_dragged_undone_and_kept, picture_of_a_pane_is_written,
    picture_without_names_shows_only_what_is_free_of_them, simulated_source_is_listed_and_recorded,
]
