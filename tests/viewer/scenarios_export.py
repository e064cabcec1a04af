"""What leaves the viewer in files, read back."""

import csv
import json
import struct
import zlib

from viewer_driver import DUMP, IDLE, at
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
    fathom(shared.program, "exam", "create", path, "--recording", shared.scan, "--calibration", shared.calibration,
           "--contours", shared.thin)
    return path


def exported_files_hold_what_is_shown(viewer, shared):
    out = viewer.folder / "out"
    run = viewer.run(named_exam(viewer, shared), window=(900, 900),
        events=told(NAMES) + exported("Export...", out) + [DUMP])
    shown = structure(run.state())
    assert set(run.state()["document"]["texts"]) >= set(NAMES.values())
    assert any(str(out) in m["text"] and not m["is_error"] for m in run.state()["messages"])
    (result,) = json.loads((out / "results.json").read_text())["structures"]
    assert result["name"] == "bladder" and abs(result["volume_ml"][result["recommended"]] / shown["volume_ml"] - 1) < 1e-9
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


def grey_pixels(path, value, rows):
    """How many pixels of the first rows of a PNG file of 8 bits a channel are about as grey as that."""
    data, width, channels, packed, at_byte = path.read_bytes(), 0, 0, b"", 8
    while at_byte < len(data):
        length, kind = struct.unpack(">I4s", data[at_byte:at_byte + 8])
        chunk = data[at_byte + 8:at_byte + 8 + length]
        if kind == b"IHDR":
            width, _, depth, colour = struct.unpack(">IIBB", chunk[:10])
            channels = {0: 1, 2: 3, 6: 4}[colour]
            assert depth == 8
        packed += chunk if kind == b"IDAT" else b""
        at_byte += length + 12
    raw, stride = zlib.decompress(packed), channels * width
    before, count = bytearray(stride), 0
    for start in range(0, rows * (stride + 1), stride + 1):
        line = bytearray(raw[start + 1:start + 1 + stride])
        for i in range(stride):
            left = line[i - channels] if i >= channels else 0
            corner = before[i - channels] if i >= channels else 0
            line[i] = (line[i] + unfiltered(raw[start], left, before[i], corner)) % 256
        shown = range(min(channels, 3))
        count += sum(all(abs(line[i + k] - value) < 3 for k in shown) for i in range(0, stride, channels))
        before = line
    return count


def unfiltered(kind, left, above, corner):
    """What a PNG line's filter took away of a byte."""
    if kind == 4:
        guess = left + above - corner
        return min((left, above, corner), key=lambda near: abs(guess - near))
    return (0, left, above, (left + above) // 2)[kind]


def burned_in_text_is_masked(viewer, shared):
    data = bytearray(shared.scan.read_bytes())
    width, height, frames = map(int, data.split(b"DimSize = ")[1].split(b"\n")[0].split())
    images = len(data) - width * height * frames
    for frame in range(frames):
        for y in range(20, 60):  # as if a name were written there
            row = images + (frame * height + y) * width
            data[row + 20:row + 180] = bytes([201]) * 160
    scan = viewer.folder / "named.mha"
    scan.write_bytes(data)
    organ = shared.outlines[5]
    (left, top), (right, bottom) = ([f(p[i] for p in organ) for i in range(2)] for f in (min, max))
    corners = [(left - 15, top - 15), (right + 15, top - 15), (right + 15, bottom + 15), (left - 15, bottom + 15)]
    viewer.run(scan, "--calibration", shared.calibration, "--contours", shared.thin, events=[
        IDLE, *exported("Export...", viewer.folder / "open"),
        *exported("Export without names...", viewer.folder / "bare"), {"key": "R"},
        *[{"click": at(*corner)} for corner in corners], {"frames": 1},
        *exported("Export without names...", viewer.folder / "masked"), DUMP])
    dim, rows = 0.75, 360  # B-scans are dimmed, and the organ begins above this row
    text, organs = ({name: grey_pixels(viewer.folder / name / "outlines.png", round(dim * grey), rows)
                     for name in ("open", "masked")} for grey in (201, 255))
    assert text["open"] > 10_000 and text["masked"] < 100, text
    assert organs["masked"] > 0.9 * organs["open"] > 1000, organs
    assert not (viewer.folder / "bare" / "outlines.png").exists()
    assert b"named" not in (viewer.folder / "masked" / "report.html").read_bytes()


def export_that_fails_is_a_message(viewer, shared):
    taken = viewer.folder / "taken"
    taken.write_text("a file of the user's own")
    run = viewer.run(shared.exam(viewer.folder),
        events=[IDLE, {"dump": "before.json"}, *exported("Export...", taken), DUMP])
    assert [m["about"] for m in run.state()["messages"] if m["is_error"]] == ["export"]
    assert "taken" in run.state()["messages"][0]["text"]
    assert taken.read_text() == "a file of the user's own"
    assert run.state()["document"] == run.state("before")["document"]


SCENARIOS = [exported_files_hold_what_is_shown, exported_without_names, burned_in_text_is_masked,
    export_that_fails_is_a_message]
