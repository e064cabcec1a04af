"""What is wrong: files, displays, scripts."""

import subprocess

from viewer_driver import DUMP, IDLE, picture
from viewer_exams import structure


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
    faults_are_messages_and_the_exam_stays, no_display_is_a_clear_line, damaged_scripts_are_refused,
]
