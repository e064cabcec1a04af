"""What leaves the viewer in files, read back."""

import csv
import json

from viewer_driver import DUMP, IDLE
from viewer_exams import fathom, structure

NAMES = {"Patient": "Mustermann", "Operator": "Sonographer", "Notes": "born in Aachen"}


def told(event_texts):
    """Fills in the texts of the exam."""
    events = [IDLE, {"click": "Exam"}]
    for field, text in event_texts.items():
        events += [{"click": field}, {"key": "Ctrl+A"}, {"text": text}, {"key": "Enter"}]
    return events + [IDLE]


def exported(entry, folder):
    return [{"menu": f"File/{entry}"}, {"frames": 2}, {"key": "Ctrl+A"}, {"text": str(folder)}, {"key": "Enter"}, IDLE]


def named_exam(viewer, shared):
    """Its folder tells a name, too."""
    path = viewer.folder / "Mustermann exam"
    fathom(shared.program, "exam", "create", path, "--recording", shared.scan, "--calibration", shared.calibration, "--contours",
           shared.thin)
    return path


def exported_files_hold_what_is_shown(viewer, shared):
    out = viewer.folder / "out"
    run = viewer.run(named_exam(viewer, shared), window=(900, 900), events=told(NAMES) + exported("Export...", out) + [DUMP])
    shown = structure(run.state())
    assert set(run.state()["document"]["texts"]) >= set(NAMES.values())
    assert any(str(out) in m["text"] and not m["is_error"] for m in run.state()["messages"])
    (result,) = json.loads((out / "results.json").read_text())["structures"]
    assert result["name"] == "bladder" and abs(result["volume_ml"]["cubic_planimetry"] / shown["volume_ml"] - 1) < 1e-9
    rows = list(csv.DictReader((out / "results.csv").open(newline="")))
    assert any("bladder" in row.values() for row in rows) and len(rows[0]) > 3
    assert any(f"{shown['volume_ml']:.4g}"[:5] in (value or "") for row in rows for value in row.values()), rows
    page = (out / "report.html").read_text()
    assert all(text in page for text in NAMES.values()) and f"{shown['volume_ml']:.2f}"[:4] in page
    assert page.count("data:image/png") >= 2 and page.rstrip().endswith("</html>")
    header = (out / "surface.ply").read_bytes().split(b"end_header")[0].decode()
    assert f"element face {shown['triangles']}\n" in header
    for name in ("outlines.png", "surface.png"):
        assert (out / name).read_bytes().startswith(b"\x89PNG\r\n"), name
    assert run.state()["document"]["edits_done"] == len(NAMES), "exporting changed the exam"


def exported_without_names(viewer, shared):
    out = viewer.folder / "out"
    run = viewer.run(named_exam(viewer, shared), window=(900, 900),
                     events=told(NAMES) + exported("Export without names...", out) + [DUMP])
    assert set(run.state()["document"]["texts"]) >= set(NAMES.values())
    files = sorted(path for path in out.rglob("*") if path.is_file())
    assert [path.name for path in files] == ["report.html", "results.csv", "results.json", "surface.ply", "surface.png"]
    for path in files:
        content = path.read_bytes().lower()
        for name in (*NAMES.values(), "Mustermann exam", shared.scan.name, str(viewer.folder)):
            assert name.lower().encode() not in content, f"{path.name} tells {name}"
    # A name may be burned into B-scans: none is there, nor a picture made of one.
    assert (out / "report.html").read_text().count("data:image/png") == 1
    assert json.loads((out / "results.json").read_text())["structures"][0]["volume_ml"]["cubic_planimetry"] > 0.3


def export_that_fails_is_a_message(viewer, shared):
    taken = viewer.folder / "taken"
    taken.write_text("a file of the user's own")
    run = viewer.run(shared.exam(viewer.folder), events=[IDLE, {"dump": "before.json"}, *exported("Export...", taken), DUMP])
    assert [m["about"] for m in run.state()["messages"] if m["is_error"]] == ["export"]
    assert "taken" in run.state()["messages"][0]["text"]
    assert taken.read_text() == "a file of the user's own"
    assert run.state()["document"] == run.state("before")["document"]


SCENARIOS = [exported_files_hold_what_is_shown, exported_without_names, export_that_fails_is_a_message]
