#!/usr/bin/env python3
"""Damaged files, made from good ones: each gives exit status 1 and one clear line, writes nothing, and stays small."""

import shutil

import damaged_documents
import damaged_meshes
import damaged_recordings
import damaged_volumes
import tracked_recordings
from program import complaint_about_error, ordinary_user, run_script, tree
from recording_file import MetaImage, Nrrd

MAX_MB = 1000
MAX_SECONDS = 20
MAX_SECONDS_SANITIZED = 120


class Suite:
    def __init__(self, program, folder, tally):
        self.program, self.folder, self.tally = program, folder, tally
        self.cases = 0
        self.good = folder / "good"
        self.good.mkdir()
        program.must_run("simulate", "--object", "sphere", "--pattern", "linear", "--frames", 6, "--seed", 3, "--out",
                         self.good / "scan.mha")
        program.must_run("convert", self.good / "scan.mha", self.good / "scan.nrrd")
        program.must_run("convert", self.good / "scan.mha", self.good / "scan.mhd")
        self.mha = MetaImage((self.good / "scan.mha").read_bytes())
        self.nrrd = Nrrd((self.good / "scan.nrrd").read_bytes())

    def arguments(self, command, recording=None, calibration=None, contours=None):
        recording = recording or self.good / "scan.mha"
        calibration = calibration or self.good / "scan.calibration.json"
        contours = contours or self.good / "scan.contours.json"
        return {
            "info": ["info", recording, "--json"],
            "measure": ["measure", recording, "--calibration", calibration, "--contours", contours, "--json"],
            "segment": ["segment", recording, "--threshold", 128, "--out", "out.json", "--json"],
            "convert": ["convert", recording, "out.nrrd", "--json"],
        }[command]

    def must_accept(self, name, arguments):
        """The control: what is not damaged is read."""
        out = self.folder / "out"
        out.mkdir()
        outcome = self.program.run(*arguments, cwd=out)
        self.tally.check(f"good: {name}", outcome.status != 0 and f"status {outcome.status}: {outcome.err}")
        shutil.rmtree(out)

    def must_refuse(self, name, files, runs, user=None):
        """Each of the runs (by name of command, given the first file's path) must refuse the files."""
        self.cases += 1
        if self.cases % self.program.share:
            return
        case, out = self.folder / "case", self.folder / "out"
        case.mkdir()
        out.mkdir()
        if user is not None:
            out.chmod(0o777)
        for file_name, content in files.items():
            if callable(content):
                content(case / file_name)
            else:
                (case / file_name).write_bytes(content)
        before = sorted(path.name for path in case.rglob("*"))
        for command, arguments in runs(case / next(iter(files), "missing.mha")).items():
            outcome = self.program.run(*arguments, cwd=out, user=user)
            self.tally.check(f"{name} ({command})", self.complaint(outcome, before, case, out))
        case.chmod(0o700)
        shutil.rmtree(case)
        shutil.rmtree(out)

    def complaint(self, outcome, before, case, out):
        complaint = complaint_about_error(outcome)
        if complaint:
            return complaint
        if list(out.iterdir()):
            return f"left behind: {sorted(tree(out))}"
        if sorted(path.name for path in case.rglob("*")) != before:
            return f"left behind beside the input: {sorted(path.name for path in case.rglob('*'))}"
        if not self.program.sanitized and outcome.peak_mb > MAX_MB:
            return f"took {outcome.peak_mb:.0f} MB"
        if outcome.seconds > (MAX_SECONDS_SANITIZED if self.program.sanitized else MAX_SECONDS):
            return f"took {outcome.seconds:.1f} s"
        return None

    def recordings(self):
        for command in damaged_recordings.EVERY:
            for good in ("scan.mha", "scan.mhd", "scan.nrrd"):
                self.must_accept(f"{good} ({command})", self.arguments(command, self.good / good))
        packed = self.folder / "packed.mha"
        packed.write_bytes(self.mha.compressed().bytes())
        self.must_accept("compressed mha", self.arguments("convert", packed))
        for name, files, commands in damaged_recordings.recordings(self.mha, self.nrrd):
            self.must_refuse(name, files, lambda path: {c: self.arguments(c, recording=path) for c in commands})

    def volumes(self):
        for good, name in ((damaged_volumes.GOOD_MHA, "volume.mha"), (damaged_volumes.GOOD_NRRD, "volume.nrrd")):
            (self.good / name).write_bytes(good.bytes())
            self.must_accept(name, self.arguments("convert", self.good / name))
            self.must_refuse(f"{name} as a picture", {name: good.bytes()},
                             lambda path: {"convert": ["convert", path, "out.png", "--json"]})
        for name, files in damaged_volumes.volumes():
            self.must_refuse(name, files, lambda path: {"convert": self.arguments("convert", recording=path)})

    def calibrations(self):
        def runs(path):
            return {"measure": self.arguments("measure", calibration=path)}

        good_xml = self.folder / "good.xml"
        good_xml.write_text(damaged_documents.GOOD_XML)
        self.must_accept("PLUS calibration", self.arguments("measure", calibration=good_xml))
        good = (self.good / "scan.calibration.json").read_bytes()
        for name, content in damaged_documents.calibrations(good):
            self.must_refuse(f"calibration: {name}", {"damaged.json": content}, runs)
        for name, content in damaged_documents.plus_calibrations():
            self.must_refuse(f"PLUS calibration: {name}", {"damaged.xml": content}, runs)
        self.must_refuse("calibration: not there", {}, runs)
        self.must_refuse("calibration: a folder", {"damaged.json": damaged_recordings.folder}, runs)
        self.must_refuse("calibration: a pipe", {"damaged.json": damaged_recordings.pipe}, runs)
        self.must_refuse("calibration: 2 GB", {"damaged.json": damaged_recordings.sparse(b"{", 2 << 30)}, runs)

    def contours(self):
        def runs(path):
            return {"measure": self.arguments("measure", contours=path)}

        good = (self.good / "scan.contours.json").read_bytes()
        for name, content in damaged_documents.contours(good, frames=6):
            self.must_refuse(f"contours: {name}", {"damaged.json": content}, runs)
        self.must_refuse("contours: not there", {}, runs)
        self.must_refuse("contours: a folder", {"damaged.json": damaged_recordings.folder}, runs)
        self.must_refuse("contours: a pipe", {"damaged.json": damaged_recordings.pipe}, runs)
        self.must_refuse("contours: 2 GB", {"damaged.json": damaged_recordings.sparse(b"{", 2 << 30)}, runs)

    def planes(self):
        def runs(path):
            return {"reslice": ["reslice", self.good / "scan.mha", "--calibration", self.good / "scan.calibration.json",
                                "--through-frame", 2, "--planes", path, "--out", "out.png", "--json"]}

        self.program.must_run("planes", self.good / "scan.mha", "--calibration", self.good / "scan.calibration.json",
                              "--out", self.good / "planes.json")
        self.must_accept("planes", runs(self.good / "planes.json")["reslice"])
        for name, content in damaged_documents.planes((self.good / "planes.json").read_bytes(), frames=6):
            self.must_refuse(f"planes: {name}", {"damaged.json": content}, runs)

    def exams(self):
        def runs(path):
            return {"info": ["info", path.parent, "--json"], "measure": ["measure", path, "--save", "--json"]}

        for name, content in damaged_documents.exams():
            self.must_refuse(f"exam: {name}", {"exam.json": content}, runs)
        self.must_refuse("exam: a folder", {"exam.json": damaged_recordings.folder}, runs)
        self.must_refuse("exam: a pipe", {"exam.json": damaged_recordings.pipe}, runs)

    def meshes(self):
        (self.good / "cube.off").write_bytes(damaged_meshes.CUBE)
        good = {}
        for kind in damaged_meshes.FORMATS:
            self.program.must_run("convert", self.good / "cube.off", self.good / f"whole.{kind}")
            good[kind] = (self.good / f"whole.{kind}").read_bytes()
            self.must_accept(f"mesh as {kind}", ["convert", self.good / f"whole.{kind}", "out.ply", "--json"])
        (self.good / "text.ply").write_bytes(damaged_meshes.text_ply())
        self.must_accept("mesh as text in ply", ["convert", self.good / "text.ply", "out.stl", "--json"])
        for name, files in damaged_meshes.meshes(good):
            self.must_refuse(f"mesh: {name}", files, lambda path: {"convert": ["convert", path, "out.ply", "--json"]})

        cube, scan = {"cube.ply": good["ply"]}, {"scan.mha": self.mha.bytes()}
        for out in ("out.mha", "out.nrrd", "out", "out.txt"):
            self.must_refuse(f"a mesh as {out}", cube, lambda path: {"convert": ["convert", path, out]})
        for kind in damaged_meshes.FORMATS:
            self.must_refuse(f"a recording as {kind}", scan, lambda path: {"convert": ["convert", path, f"out.{kind}"]})
        self.must_refuse("a compressed mesh", cube, lambda path: {"convert": ["convert", "--compress", path, "out.ply"]})

    def phantoms(self):
        bead = self.good / "bead.mha"
        bead.write_bytes(tracked_recordings.over_point())

        def runs(path):
            return {"calibrate": ["calibrate", "spatial", bead, "--phantom", path, "--out", "out.json"]}

        for name, content in damaged_documents.phantoms(tracked_recordings.wire_phantom()):
            self.must_refuse(f"phantom: {name}", {"damaged.json": content}, runs)
        self.must_refuse("phantom: not there", {}, runs)
        self.must_refuse("phantom: a folder", {"damaged.json": damaged_recordings.folder}, runs)
        self.must_refuse("phantom: 2 GB", {"damaged.json": damaged_recordings.sparse(b"{", 2 << 30)}, runs)

    def landmarks(self):
        good = self.good / "landmarks.csv"
        good.write_bytes(damaged_documents.GOOD_LANDMARKS)

        def runs(path):
            return {"from": ["register", "landmarks", "--from", path, "--to", good],
                    "to": ["register", "landmarks", "--from", good, "--to", path]}

        self.must_accept("landmarks", runs(good)["from"])
        for name, content in damaged_documents.landmarks():
            self.must_refuse(f"landmarks: {name}", {"damaged.csv": content}, runs)
        self.must_refuse("landmarks: not there", {}, runs)
        self.must_refuse("landmarks: a folder", {"damaged.csv": damaged_recordings.folder}, runs)
        self.must_refuse("landmarks: a pipe", {"damaged.csv": damaged_recordings.pipe}, runs)
        self.must_refuse("landmarks: 2 GB", {"damaged.csv": damaged_recordings.sparse(b"1,2,3", 2 << 30)}, runs)

    def study_results(self):
        def runs(path):
            return {"accuracy merge": ["accuracy", "merge", path, "--out", "page"]}

        self.program.must_run("accuracy", "--table", "2.13", "--samples", 1, "--out", self.good / "study")
        self.must_accept("results of a study", runs(self.good / "study" / "2.13.json")["accuracy merge"])
        for name, content in damaged_documents.study_results((self.good / "study" / "2.13.json").read_bytes()):
            self.must_refuse(f"results of a study: {name}", {"damaged.json": content}, runs)
        self.must_refuse("results of a study: not there", {}, runs)
        self.must_refuse("results of a study: a folder", {"damaged.json": damaged_recordings.folder}, runs)
        self.must_refuse("results of a study: a pipe", {"damaged.json": damaged_recordings.pipe}, runs)
        self.must_refuse("results of a study: 2 GB", {"damaged.json": damaged_recordings.sparse(b"{", 2 << 30)}, runs)

    def without_permission(self):
        """Files that may not be read, as a user who is not root."""
        user = ordinary_user(self.program, self.folder)
        if user is False:
            self.tally.skip("files without permission", "the program cannot be run as another user than root here")
            return
        for name, content in (("damaged.mha", self.mha.bytes()), ("damaged.nrrd", self.nrrd.bytes())):
            def locked(path):
                path.write_bytes(content)
                path.chmod(0)

            self.must_refuse(f"{name} without permission to read", {name: locked}, lambda path: {
                c: self.arguments(c, recording=path) for c in damaged_recordings.EVERY}, user=user)

        def locked_json(path):
            path.write_bytes((self.good / "scan.contours.json").read_bytes())
            path.chmod(0)

        self.must_refuse("contours without permission to read", {"damaged.json": locked_json}, lambda path: {
            "measure": self.arguments("measure", contours=path)}, user=user)


def body(program, folder, tally, _root):
    suite = Suite(program, folder, tally)
    suite.recordings()
    suite.volumes()
    suite.calibrations()
    suite.contours()
    suite.phantoms()
    suite.landmarks()
    suite.planes()
    suite.exams()
    suite.study_results()
    suite.without_permission()


if __name__ == "__main__":
    run_script(__doc__, body)
