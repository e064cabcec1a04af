"""What is wrong: files, displays, scripts."""

import json
import shutil
import subprocess

from viewer_driver import DUMP, IDLE, picture
from viewer_exams import fathom, structure


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


def faults_are_copied(viewer, shared):
    run = viewer.run(shared.exam(viewer.folder), window=(900, 900), events=[
        IDLE, {"drop": str(viewer.folder / "nothing.mha")}, IDLE, {"dump": "said.json"}, picture("said"),
        {"click": "Copy"},
        {"click": "Dismiss"}, {"frames": 2}, {"click": "Exam"}, {"click": "Notes"}, {"key": "Ctrl+V"},
        {"key": "Enter"}, IDLE, DUMP,
        picture("dismissed")])
    (message,) = run.state("said")["messages"]
    assert message["is_error"] and message["about"] == "nothing.mha" and run.state()["messages"] == []
    assert run.state()["document"]["texts"][3] == message["text"], "Copy gives another text"
    red = lambda r, g, b: r > 200 and 80 < g < 130 and 70 < b < 130  # noqa: E731
    assert run.picture("said").count(red) > run.picture("dismissed").count(red) + 100


def damaged_exams_leave_the_open_one_alone(viewer, shared):
    exam = shared.exam(viewer.folder)
    listed = json.loads((exam / "exam.json").read_text())
    damages = {}

    def damaged(name, file, change):
        """A copy of the exam with one file changed."""
        copy = viewer.folder / name
        shutil.copytree(exam, copy)
        (copy / "exam.json").write_text(json.dumps({**listed, "recordings": ["scan.mha"]}))
        if not (copy / "scan.mha").exists():
            shutil.copy(shared.scan, copy / "scan.mha")
        content = (copy / file).read_bytes()
        (copy / file).write_bytes(change(content))
        damages[name] = file

    damaged("half outlines", listed["structures"], lambda content: content[:len(content) // 2])
    damaged("half calibration", listed["calibration"], lambda content: content[:len(content) // 2])
    damaged("half recording", "scan.mha", lambda content: content[:len(content) // 2])
    damaged("no header", "scan.mha", lambda content: content[:20])
    damaged("newer", "exam.json", lambda content: content.replace(b'"fathom_exam": 1', b'"fathom_exam": 99'))
    events = [IDLE, {"dump": "before.json"}]
    for name in damages:
        events += [{"drop": str(viewer.folder / name)}, IDLE]
    run = viewer.run(exam, events=events + [DUMP, picture(of="pane:Messages")])
    said = {m["about"]: m["text"] for m in run.state()["messages"] if m["is_error"]}
    assert set(said) == set(damages), said
    for name, file in damages.items():
        assert file in said[name] and len(said[name]) < 400, (name, said[name])
    assert run.state()["document"] == run.state("before")["document"], "the open exam has changed"
    assert run.picture().count(lambda r, g, b: r > 180 and g < 140) > 300


def exam_saved_over_another_is_refused(viewer, shared):
    other = viewer.folder / "other"
    fathom(shared.program, "exam", "create", other, "--recording", shared.scan, "--calibration", shared.calibration)
    before = {path: path.read_bytes() for path in other.rglob("*") if path.is_file()}
    run = viewer.run(shared.exam(viewer.folder), events=[
        IDLE, {"dump": "before.json"}, {"menu": "File/Save as..."}, {"key": "Ctrl+A"}, {"text": str(other)},
        {"key": "Enter"}, IDLE,
        DUMP, picture(of="pane:Messages")])
    assert [m["about"] for m in run.state()["messages"]] == ["save"]
    assert str(other) not in run.state()["recent"]
    assert {path: path.read_bytes() for path in other.rglob("*") if path.is_file()} == before
    assert run.state()["document"] == run.state("before")["document"]
    assert run.picture().width > 200


def no_display_is_a_clear_line(viewer, shared):
    done = subprocess.run([shared.program, "view"], capture_output=True, text=True,
                          env={k: v for k,
                          v in viewer.environment().items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")})
    assert done.returncode == 1 and done.stderr.startswith("fathom: error: display: "), done.stderr
    assert len(done.stderr.splitlines()) == 1


def damaged_scripts_are_refused(viewer, shared):
    run = viewer.run(events=[{"click": "no such thing"}], fails=True)
    assert run.code == 1 and "no such thing" in run.errors
    run = viewer.run(events=[{"jump": 1}], fails=True)
    assert run.code == 1 and "events[0]" in run.errors


SCENARIOS = [
    faults_are_messages_and_the_exam_stays, faults_are_copied, damaged_exams_leave_the_open_one_alone,
    exam_saved_over_another_is_refused, no_display_is_a_clear_line, damaged_scripts_are_refused,
]
