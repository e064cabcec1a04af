#!/usr/bin/env python3
"""Exams: made, shown, measured with several sweeps and recordings; what is wrong with them is refused."""

import json
import re
import shutil

from program import complaint_about_error, run_script, tree

FRAMES = 31


def statuses(content, lost):
    return re.sub(rb"(Seq_Frame(\d+)_\w+TransformStatus = )OK",
                  lambda match: match.group(1) + (b"INVALID" if int(match.group(2)) in lost else b"OK"), content)


def part_of(contours, frames, recording):
    """The outlines on these frames, as those of another recording."""
    structure = contours["structures"][0]
    return [{**item, "recording": recording} for item in structure["contours"] if item["frame"] in frames]


def files(folder):
    return [(path.name, path.read_bytes()) for path in sorted(folder.rglob("*")) if path.is_file()]


class Exams:
    def __init__(self, program, folder, tally):
        self.program, self.folder, self.tally = program, folder, tally
        self.scan = folder / "scan.mha"
        program.must_run("simulate", "--object", "sphere", "--pattern", "linear", "--frames", FRAMES, "--out", self.scan)
        self.calibration = folder / "scan.calibration.json"
        self.truth = json.loads((folder / "scan.truth.json").read_text())["volume_ml"]
        outlines = json.loads((folder / "scan.contours.json").read_text())
        # The same scan twice, as two recordings of one exam, each outlined on every frame.
        shutil.copy(self.scan, folder / "again.mha")
        self.twice = folder / "twice.json"
        name = outlines["structures"][0]["name"]
        self.twice.write_text(json.dumps({"fathom_contours": 1, "structures": [{
            "name": name, "contours": part_of(outlines, range(FRAMES), 0) + part_of(outlines, range(FRAMES), 1)}]}))
        self.exam = folder / "exam"

    def must_run(self, *arguments):
        return self.program.must_run(*arguments, cwd=self.folder)

    def check(self, name, complaint):
        self.tally.check(name, complaint)

    def refused(self, name, *arguments):
        before = tree(self.folder)
        outcome = self.program.run(*arguments, cwd=self.folder)
        changed = tree(self.folder) != before
        self.check(f"refused: {name}", complaint_about_error(outcome) or (changed and "files changed"))

    def changed_exam(self, **changes):
        """A copy of the exam whose exam.json has other values."""
        copy = self.folder / "changed"
        shutil.rmtree(copy, ignore_errors=True)
        shutil.copytree(self.exam, copy)
        document = {**json.loads((copy / "exam.json").read_text()), **changes}
        (copy / "exam.json").write_text(json.dumps({k: v for k, v in document.items() if v is not ...}))
        return copy

    def one_recording(self):
        exam = self.folder / "single"
        self.must_run("exam", "create", exam, "--recording", self.scan, "--calibration", self.calibration, "--contours",
                      self.folder / "scan.contours.json", "--patient", "P-1", "--notes", "full bladder")
        stored = json.loads((exam / "exam.json").read_text())
        self.check("the exam names its files", stored["recordings"] != ["scan.mha"] or stored["patient"] != "P-1")
        self.check("recordings are copied to the byte", (exam / "scan.mha").read_bytes() != self.scan.read_bytes())
        alone = self.must_run("measure", self.scan, "--calibration", self.calibration, "--contours",
                              self.folder / "scan.contours.json", "--json").json()["structures"][0]["volume_ml"]
        document = {**stored, "from_elsewhere": {"kept": [1]}}
        (exam / "exam.json").write_text(json.dumps(document))
        saved = self.must_run("measure", exam, "--save", "--json").json()
        self.check("an exam measures as its files do", saved["structures"][0]["volume_ml"] != alone and saved)
        stored = json.loads((exam / "exam.json").read_text())
        self.check("results are saved", stored["results"] != saved)
        self.check("unknown keys are kept", stored.get("from_elsewhere") != {"kept": [1]})
        for arguments in (["sweeps", exam, "--save"], ["planes", exam, "--save", "--add", "1,0,0,900"],
                          ["surface", exam, "--out", "s.ply"], ["reconstruct", exam, "--spacing-mm", 1, "--out", "v.mha"],
                          ["convert", exam, "c.mha"], ["segment", exam, "--threshold", 128, "--out", "seg.json"],
                          ["info", exam]):
            self.must_run(*arguments)
        stored = json.loads((exam / "exam.json").read_text())
        self.check("sweeps and planes are saved", len(stored["sweeps"]) != 1 or len(stored["dividing_planes"]) != 1)
        told = self.must_run("info", exam, "--json").json()
        self.check("info tells of exam and recording", told["width"] <= 0 or told["exam"]["patient"] != "P-1")
        again = self.must_run("measure", exam, "--no-surfaces", "--json").json()["structures"][0]
        self.check("a plane through nothing changes nothing", abs(
            again["volume_ml"]["cubic_planimetry"] / alone["cubic_planimetry"] - 1) > 1e-9 and again)
        self.must_run("exam", "update", exam, "--notes", "empty bladder", "--contours", self.twice.parent / "seg.json")
        stored = json.loads((exam / "exam.json").read_text())
        self.check("an update keeps the rest", (stored["notes"], stored["patient"], stored["structures"]) != (
            "empty bladder", "P-1", "seg.json") and stored)
        self.check("results of other contours are dropped", stored.get("results") and stored)
        elsewhere = self.folder / "elsewhere"
        elsewhere.mkdir()
        (elsewhere / "seg.json").write_text((self.folder / "scan.contours.json").read_text())
        self.must_run("exam", "update", exam, "--contours", elsewhere / "seg.json")
        stored = json.loads((exam / "exam.json").read_text())
        self.check("a file of the same name replaces none", stored["structures"] != "seg-2.json" or
                   (exam / "seg.json").read_bytes() != (self.folder / "seg.json").read_bytes())
        self.must_run("convert", self.scan, elsewhere / "more.mhd")
        self.must_run("exam", "update", exam, "--recording", elsewhere / "more.mhd")
        told = self.must_run("info", exam, "--json").json()["recordings"]
        self.check("two files of a recording become one", [item["file"] for item in told] != ["scan.mha", "more.mha"] or
                   told[0]["transforms"] != told[1]["transforms"] and told)
        odd = elsewhere / "od\nd.mha"
        odd.write_bytes(self.scan.read_bytes())
        self.refused("a name that exam.json cannot hold", "exam", "update", exam, "--recording", odd)
        self.refused("an exam in the place of another", "exam", "create", exam, "--recording", self.scan)

    def two_recordings(self):
        exam = self.exam
        self.must_run("exam", "create", exam, "--recording", self.scan, "--recording", self.folder / "again.mha",
                      "--calibration", self.calibration, "--contours", self.twice)
        apart = self.must_run("measure", exam, "--json").json()["structures"][0]
        self.check("no planes, no sum", apart["volume_ml"]["cubic_planimetry"] is not None and apart)
        self.check("no planes, no loss", any(part["loss_ml"] is not None for part in apart["partitions"]) and apart)
        self.check("a volume for each sweep", [abs(p["volume_ml"]["cubic_planimetry"] / self.truth - 1) > 0.01
                                               for p in apart["partitions"]] != [False, False] and apart)
        self.check("and a warning", not any("no sum" in warning for warning in apart["warnings"]) and apart)
        self.check("surfaces of whole sweeps", any(part["volume_ml"]["disc_guided"] is None
                                                   for part in apart["partitions"]) and apart)
        self.must_run("sweeps", exam, "--save")
        middle = self.middle()
        for plane in ("1,0,0", "0,1,0", "0,0,1"):
            normal = [float(text) for text in plane.split(",")]
            planes = self.folder / "planes.json"
            planes.write_text(json.dumps({"dividing_planes": [
                {"normal": normal, "offset_mm": sum(a * b for a, b in zip(normal, middle))}]}))
            divided = self.must_run("measure", exam, "--planes", planes, "--json").json()["structures"][0]
            parts = [part["volume_ml"]["cubic_planimetry"] or 0 for part in divided["partitions"]]
            total = divided["volume_ml"]["cubic_planimetry"]
            self.check(f"the parts add up ({plane})", total is not None and abs(sum(parts) - total) > 1e-9 and divided)
            for method in ("shape_based", "centroid_guided", "disc_guided", "disc_guided_curved"):
                by_surface = [part["volume_ml"][method] for part in divided["partitions"]]
                wrong = None in by_surface or abs(sum(by_surface) - divided["volume_ml"][method]) > 1e-9 or \
                    abs(divided["volume_ml"][method] - total) > 0.01 * total
                self.check(f"{method}: parts add up, near planimetry ({plane})", wrong and divided)
            self.check(f"keys of a part ({plane})", any({"sweep", "volume_ml", "loss_ml", "loss"} - set(part)
                                                        for part in divided["partitions"]) and divided)
        told = self.must_run("info", exam, "--json").json()
        self.check("frames of both", told["frames"] != 2 * FRAMES and told)
        self.must_run("measure", exam)
        for arguments in (["surface", exam, "--out", "s2.ply"], ["convert", exam, "c2.mha"],
                          ["reconstruct", exam, "--spacing-mm", 1, "--out", "v2.mha"]):
            self.refused(f"{arguments[0]} of two recordings", *arguments)
        # Both sweeps have the same centre: no plane lies between them, and that is said.
        placed = self.must_run("planes", exam, "--json").json()
        self.check("sweeps on top of each other", not placed["warnings"] and placed)

    def recording_without_sweeps(self):
        """A recording that came after the sweeps were saved."""
        exam = self.folder / "later"
        self.must_run("exam", "create", exam, "--recording", self.scan, "--recording", self.folder / "again.mha",
                      "--calibration", self.calibration, "--contours", self.twice)
        document = json.loads((exam / "exam.json").read_text())
        document["sweeps"] = [{"recording": 0, "first": 0, "last": FRAMES - 1}]
        (exam / "exam.json").write_text(json.dumps(document))
        placed = self.must_run("planes", exam, "--json").json()
        self.check("a recording without a sweep is named", not any("again.mha" in text for text in placed["warnings"]) and placed)
        made = self.must_run("surface", exam, "--out", "later.ply", "--json").json()
        self.check("the surface of the one sweep", abs(made["volume_ml"] / self.truth - 1) > 0.02 and made)
        measured = self.must_run("measure", exam, "--json", "--no-surfaces").json()["structures"][0]
        for warnings in (made["warnings"], measured["warnings"]):
            self.check("outlines in no sweep are said to be unused",
                       not any("of recording 1" in text and "no sweep" in text for text in warnings) and warnings)

    def middle(self):
        """Where the middle of the middle frame lies."""
        calibration = json.loads(self.calibration.read_text())
        m = calibration["image_to_probe"]
        text = re.search(rb"Seq_Frame0*%d_ProbeToTrackerTransform = ([^\n]+)" % (FRAMES // 2), self.scan.read_bytes())
        p = [float(number) for number in text.group(1).split()]
        x, y = calibration["width"] / 2, calibration["height"] / 2
        probe = [m[4 * i] * x + m[4 * i + 1] * y + m[4 * i + 3] for i in range(3)]
        return [sum(p[4 * i + j] * probe[j] for j in range(3)) + p[4 * i + 3] for i in range(3)]

    def overlapping(self):
        """Two sweeps whose second begins a little behind the end of the first."""
        scan = self.folder / "overlap.mha"
        self.must_run("simulate", "--object", "sphere", "--pattern", "sweeps-a", "--frames", 46, "--out", scan)
        outlines = json.loads((self.folder / "overlap.contours.json").read_text())
        for contour in outlines["structures"][0]["contours"]:
            contour["closed"] = True
        (self.folder / "closed.json").write_text(json.dumps(outlines))
        measured = self.must_run("measure", scan, "--calibration", self.folder / "overlap.calibration.json", "--contours",
                                 self.folder / "closed.json", "--no-surfaces", "--json").json()["structures"][0]
        self.check("sweeps that overlap have no sum", (
            measured["volume_ml"]["cubic_planimetry"] is not None or len(measured["partitions"]) != 2) and measured)

    def undivided(self):
        """One recording, no planes: two sweeps that carry on are measured as one, two that see the same part are not."""
        content = statuses(self.scan.read_bytes(), range(13, 18))
        outlines = json.loads((self.folder / "scan.contours.json").read_text())
        structure = outlines["structures"][0]
        structure["contours"] = [item for item in structure["contours"] if item["frame"] not in range(13, 18)]
        (self.folder / "parts.json").write_text(json.dumps(outlines))
        poses = dict(re.findall(rb"Seq_Frame(\d+)_ProbeToTrackerTransform = ([^\n]+)", content))
        back = re.sub(rb"(Seq_Frame(\d+)_ProbeToTrackerTransform = )[^\n]+", lambda match: match.group(1) + (
            poses[b"%04d" % (int(match.group(2)) - 10)] if int(match.group(2)) >= 18 else poses[match.group(2)]), content)
        for name, recording, several in (("carry on", content, False), ("go back", back, True)):
            (self.folder / "two.mha").write_bytes(recording)
            measured = self.must_run("measure", self.folder / "two.mha", "--calibration", self.calibration, "--contours",
                                     self.folder / "parts.json", "--no-surfaces", "--json").json()["structures"][0]
            found = (len(measured["partitions"]), measured["volume_ml"]["linear_planimetry"] is None)
            made = self.must_run("surface", self.folder / "two.mha", "--calibration", self.calibration, "--contours",
                                 self.folder / "parts.json", "--out", self.folder / "two.ply", "--json").json()
            self.check(f"a surface through two sweeps that {name}", (made["volume_ml"] is None) != several and made)
            self.check(f"two sweeps that {name}", found != ((2, True) if several else (0, False)) and measured)

    def bad_planes(self):
        content = self.scan.read_bytes()
        (self.folder / "none.mha").write_bytes(statuses(content, range(FRAMES)))
        (self.folder / "few.mha").write_bytes(statuses(content, range(2, FRAMES)))
        drawn = ["--calibration", self.calibration, "--contours", self.folder / "scan.contours.json", "--no-surfaces"]

        def with_planes(*planes, sweeps=None):
            document = {"dividing_planes": [{"normal": n, "offset_mm": o} for n, o in planes]}
            if sweeps is not None:
                document["sweeps"] = [{"first": first, "last": last} for first, last in sweeps]
            (self.folder / "p.json").write_text(json.dumps(document))
            return self.folder / "p.json"

        def measured(planes):
            return self.must_run("measure", self.scan, *drawn, "--planes", planes, "--json").json()["structures"][0]

        whole = measured(with_planes())["volume_ml"]["linear_planimetry"]
        parallel = [([0, 0, 1], offset) for offset in range(-16, 16)]
        for name, planes in (("through nothing", [([1, 0, 0], 1e5)]), ("32 parallel ones", parallel),
                             ("the same plane twice", [([1, 0, 0], 0)] * 2)):
            volume = measured(with_planes(*planes))["volume_ml"]["linear_planimetry"]
            self.check(f"one sweep, planes {name}", abs(volume / whole - 1) > 1e-9 and volume)
        one = measured(with_planes(([0, 0, 1], 0), sweeps=[(0, 0), (1, FRAMES - 1)]))
        self.check("a sweep of one frame", not one["partitions"] and one)
        for name, planes in (
                ("33 planes", with_planes(*parallel, ([1, 0, 0], 0))),):
            self.refused(name, "measure", self.scan, *drawn, "--planes", planes)
        for name, sweeps in (("sweeps that overlap", [(0, 10), (10, 20)]), ("a sweep beyond the recording", [(0, FRAMES)]),
                             ("a sweep that runs backward", [(5, 2)])):
            self.refused(name, "measure", self.scan, *drawn, "--planes", with_planes(([0, 0, 1], 0), sweeps=sweeps))
        self.refused("all frames invalid", "measure", self.folder / "none.mha", *drawn, "--planes",
                     with_planes(([0, 0, 1], 0)))
        self.refused("a sweep without a pose", "measure", self.folder / "few.mha", *drawn, "--planes",
                     with_planes(([0, 0, 1], 0), sweeps=[(0, 1), (2, FRAMES - 1)]))
        outcome = self.program.run("measure", self.scan, cwd=self.folder)
        self.check("a recording without a calibration is a wrong command line", outcome.status != 2 and f"{outcome}")
        outcome = self.program.run("measure", self.scan, *drawn, "--save", cwd=self.folder)
        self.check("nothing to save to is a wrong command line", outcome.status != 2 and f"{outcome}")
        outcome = self.program.run("measure", self.folder / "exam", "--contours", self.folder / "scan.contours.json", "--save")
        self.check("results of other files are not saved", (outcome.status != 2 or "own files" not in outcome.err) and f"{outcome}")

    def reports(self):
        exam = self.folder / "single"
        before = tree(exam)
        self.must_run("exam", "update", exam, "--patient", "P-1 <Smith>", "--operator", "Jones")
        self.must_run("exam", "report", exam, "--out", "report.html")
        report = (self.folder / "report.html").read_text()
        self.check("the report has the patient's name as text", "P-1 &lt;Smith&gt;" not in report or "<Smith>" in report)
        volume = self.must_run("measure", exam, "--json").json()["structures"][0]["volume_ml"]["cubic_planimetry"]
        self.check("the report has the volume", f"<td>{volume:.2f}</td>" not in report and volume)
        outcome = self.must_run("exam", "export", exam, "--out", "out", "--anonymous", "--clip", "10,10,50,50",
                                "--recordings", "--json").json()
        self.check("the export says what it wrote", set(outcome["files"]) != {
            "results.json", "results.csv", "report.html", "surface.ply", "surface.png", "outlines.png", "exam"} and outcome)
        words = b"".join(re.sub(rb"base64,[^\"]*", b"", content if name.endswith((".html", ".json", ".csv")) else b"")
                         for name, content in files(self.folder / "out"))
        names = [name for name in (b"Smith", b"Jones", b"scan.mha", b"full bladder") if name in words]
        self.check("the anonymous export has no names", names)
        copy = self.must_run("measure", self.folder / "out" / "exam", "--json").json()["structures"][0]["volume_ml"]
        self.check("the exported exam measures the same", abs(copy["cubic_planimetry"] - volume) > 1e-9 and copy)
        self.check("the exam is left alone", set(tree(exam)) != set(before) and set(tree(exam)) ^ set(before))
        self.refused("anonymous recordings without an area", "exam", "export", exam, "--out", "new", "--anonymous",
                     "--recordings")
        self.refused("an area outside of the image", "exam", "export", exam, "--out", "new", "--anonymous", "--clip",
                     "0,0,9999,9999", "--recordings")
        self.refused("a report of no exam", "exam", "report", self.scan, "--out", "new.html")

    def bad_exams(self):
        frames = {"recording": 0, "first": 0, "last": FRAMES}
        damages = {
            "no recordings": {"recordings": []}, "another's recording": {"recordings": ["../scan.mha"]},
            "an absolute path": {"recordings": [str(self.scan)]}, "a missing recording": {"recordings": ["gone.mha"]},
            "a missing calibration": {"calibration": "gone.json"}, "missing contours": {"structures": "gone.json"},
            "no calibration": {"calibration": ...}, "no contours": {"structures": ...},
            "a sweep of another recording": {"sweeps": [{**frames, "recording": 2, "last": 1}]},
            "a sweep beyond the recording": {"sweeps": [frames]},
            "a plane without a length": {"dividing_planes": [{"normal": [0, 0, 0], "offset_mm": 1}]},
            "another version": {"fathom_exam": 2}, "the folder itself": {"recordings": ["."]},
        }
        for name, changes in damages.items():
            copy = self.changed_exam(**changes)
            self.refused(f"exam: {name}", "measure", copy, "--no-surfaces", "--save")
        link = self.changed_exam(recordings=["link.mha"], sweeps=[])
        (link / "link.mha").symlink_to(self.scan)
        self.refused("exam: a link out of it", "info", link)
        (self.folder / "empty").mkdir()
        self.refused("a folder that is no exam", "info", self.folder / "empty")
        for name, arguments in (("a missing recording", ["--recording", "gone.mha"]),
                                ("a missing calibration", ["--recording", self.scan, "--calibration", "gone.json"]),
                                ("contours as calibration", ["--recording", self.scan, "--calibration", self.twice]),
                                ("contours of two recordings", ["--recording", self.scan, "--contours", self.twice])):
            self.refused(f"exam create: {name}", "exam", "create", self.folder / "new", *arguments)


def body(program, folder, tally, _root):
    exams = Exams(program, folder, tally)
    exams.one_recording()
    exams.reports()
    exams.two_recordings()
    exams.overlapping()
    exams.recording_without_sweeps()
    exams.undivided()
    exams.bad_planes()
    exams.bad_exams()


if __name__ == "__main__":
    run_script(__doc__, body)
