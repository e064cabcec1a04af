#!/usr/bin/env python3
"""Writes that fail leave every old file as it was, byte for byte, and no new one."""

import os
import shutil
import subprocess

from program import complaint_about_error, ordinary_user, run_script, tree
from recording_file import MetaImage
from surfaces import Grid, ball
from tracked_recordings import over_floor

MIB = 1 << 20
TEMPORAL = "calibrate temporal"  # its complaint is longer than its file, so no limit leaves room for one only
# Commands that write less than what a small disk holds.
SMALL = ("convert to compressed mha", "convert to compressed nrrd", "segment", "surface", "isosurface", "eqnsurf", TEMPORAL,
         "reslice")


class Writes:
    """Every command that writes files, with what it writes to a folder."""

    def __init__(self, program, folder):
        self.program = program
        self.scan = folder / "source" / "scan.mha"
        self.scan.parent.mkdir()
        program.must_run("simulate", "--object", "sphere", "--pattern", "linear", "--frames", 8, "--out", self.scan)
        grid = Grid((12, 11, 10), (1, 1, 1))
        self.volume = self.scan.with_name("volume.mha")
        self.volume.write_bytes(grid.volume(ball(grid.middle(), 3.5)))
        self.floor = self.scan.with_name("floor.mha")
        self.floor.write_bytes(over_floor(0.0)[2])

    def commands(self, out):
        simulate = ["simulate", "--object", "cone", "--pattern", "linear", "--frames", 12]
        return {
            "simulate": [*simulate, "--out", out / "simulated.mha"],
            "convert to mha": ["convert", self.scan, out / "a.mha"],
            "convert to compressed mha": ["convert", "--compress", self.scan, out / "b.mha"],
            "convert to mhd": ["convert", self.scan, out / "c.mhd"],
            "convert to nrrd": ["convert", self.scan, out / "d.nrrd"],
            "convert to compressed nrrd": ["convert", "--compress", self.scan, out / "e.nrrd"],
            "segment": ["segment", self.scan, "--threshold", 128, "--out", out / "f.json"],
            "surface": ["surface", self.scan, "--calibration", self.scan.with_name("scan.calibration.json"),
                        "--contours", self.scan.with_name("scan.contours.json"), "--out", out / "g.ply"],
            "isosurface": ["isosurface", self.volume, "--value", 0, "--out", out / "h.stl"],
            "eqnsurf": ["eqnsurf", "x^2+y^2+z^2-1", "--bounds", "-2,2,-2,2,-2,2", "--spacing", 0.2, "--out",
                        out / "i.obj"],
            TEMPORAL: ["calibrate", "temporal", "--image", self.floor, "--out", out / "j.json"],
            "reslice": ["reslice", self.scan, "--calibration", self.scan.with_name("scan.calibration.json"),
                        "--through-frame", 4, "--rotate-deg", 30, "--out", out / "k.png"],
        }

    def old_files(self, out):
        """Puts a short file in the place of everything that the commands would write."""
        out.mkdir(exist_ok=True)
        for name in ("simulated.mha", "simulated.calibration.json", "simulated.truth.json", "simulated.contours.json",
                     "a.mha", "b.mha", "c.mhd", "c.raw", "d.nrrd", "e.nrrd", "f.json", "g.ply",
                     "h.stl", "i.obj", "j.json", "k.png"):
            (out / name).write_text(f"old {name}\n")


def must_fail(program, tally, name, out, arguments, **options):
    before = tree(out)
    complaint = complaint_about_error(program.run(*arguments, **options))
    if not complaint and tree(out) != before:
        after = tree(out)
        changed = sorted(n for n in before.keys() | after.keys() if before.get(n, "-") != after.get(n, "-"))
        complaint = f"changed: {changed}"
    tally.check(name, complaint)


def sanity(program, folder, tally, writes):
    """The control: the same commands write when nothing is in the way."""
    out = folder / "free"
    writes.old_files(out)
    for name, arguments in writes.commands(out).items():
        outcome = program.run(*arguments)
        tally.check(f"{name}, nothing in the way", outcome.status != 0 and outcome.err)
    leftovers = [n for n, content in tree(out).items() if content.startswith(b"old ")]
    tally.check("everything was replaced", leftovers and f"still old: {leftovers}")
    hidden = [path.name for path in out.iterdir() if path.name.startswith(".")]
    tally.check("no temporary file stays", hidden and f"{hidden}")


def full_disk(program, folder, tally, writes):
    out = folder / "full"
    out.mkdir()
    mounted = os.geteuid() == 0 and subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", out], stderr=subprocess.DEVNULL, check=False).returncode == 0
    if not mounted:
        tally.skip("writing to a full disk", "needs the right to mount a small one; see the limited file size instead")
        return
    try:
        writes.old_files(out)
        for name, arguments in writes.commands(out).items():
            if name not in SMALL:
                must_fail(program, tally, f"{name}, disk too small", out, arguments)
        with open(out / "filler", "wb", buffering=0) as filler:
            try:
                while True:
                    filler.write(bytes(4096))
            except OSError:
                pass
        for name, arguments in writes.commands(out).items():
            must_fail(program, tally, f"{name}, disk full", out, arguments)
    finally:
        subprocess.run(["umount", out], check=True)


def limited_file_size(program, folder, tally, writes):
    out = folder / "limited"
    writes.old_files(out)
    for name, arguments in writes.commands(out).items():
        if name != TEMPORAL:
            must_fail(program, tally, f"{name}, files limited to 2 kB", out, arguments, max_file_bytes=2000)
    for name, arguments in writes.commands(out).items():
        if name not in SMALL:
            must_fail(program, tally, f"{name}, files limited to 300 kB", out, arguments, max_file_bytes=300_000)


def no_permission(program, folder, tally, writes):
    user = ordinary_user(program, folder)
    if user is False:
        tally.skip("writing without permission", "the program cannot be run as another user than root here")
        return
    out = folder / "locked"
    writes.old_files(out)
    out.chmod(0o555)
    for name, arguments in writes.commands(out).items():
        must_fail(program, tally, f"{name}, no permission in the folder", out, arguments, user=user)
    out.chmod(0o777)
    for path in out.iterdir():
        path.chmod(0o444)
    for name, arguments in writes.commands(out).items():
        must_fail(program, tally, f"{name}, file write-protected", out, arguments, user=user)


def something_in_the_way(program, folder, tally, writes):
    out = folder / "blocked"
    for name, arguments in writes.commands(out).items():
        target = out / arguments[-1].name
        neighbours = {"simulated.mha": ["simulated.truth.json", "simulated.calibration.json"], "c.mhd": ["c.raw"]}
        for blocked in [target.name, *neighbours.get(target.name, [])]:
            writes.old_files(out)
            (out / blocked).unlink()
            (out / blocked).mkdir()
            (out / blocked / "inside").write_text("kept")
            must_fail(program, tally, f"{name}, {blocked} is a folder", out, arguments)
            shutil.rmtree(out)
    for name, arguments in writes.commands(folder / "no such folder").items():
        must_fail(program, tally, f"{name}, folder missing", folder, arguments)
    writes.old_files(out)
    for target in (out, out / "x.xyz", out / "x", "/dev/null", "/dev/null/x.mha", out / ("x" * 300 + ".mha")):
        must_fail(program, tally, f"convert to {str(target)[-20:]}", out, ["convert", writes.scan, target])


def onto_itself(program, folder, tally, writes):
    """Writing a recording over itself gives the same recording."""
    target = folder / "self.mha"
    shutil.copy(writes.scan, target)
    program.run("convert", target, target)
    before, after = MetaImage(writes.scan.read_bytes()), MetaImage(target.read_bytes())
    tally.check("convert onto itself", before.pixels != after.pixels and "the pixels are others")


def body(program, folder, tally, _root):
    writes = Writes(program, folder)
    sanity(program, folder, tally, writes)
    full_disk(program, folder, tally, writes)
    limited_file_size(program, folder, tally, writes)
    no_permission(program, folder, tally, writes)
    something_in_the_way(program, folder, tally, writes)
    onto_itself(program, folder, tally, writes)


if __name__ == "__main__":
    run_script(__doc__, body)
