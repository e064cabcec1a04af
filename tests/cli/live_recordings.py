#!/usr/bin/env python3
"""Live recording: what is recorded, what is refused, and what `recover` gives back after SIGKILL, cuts and full disks."""

import json
import os
import random
import re
import shutil
import signal
import subprocess
import time
import zlib
from pathlib import Path

from program import complaint_about_error, ordinary_user, run_script, tree
from tracked_recordings import pose_text, recording, rotation

WIDTH, HEIGHT = 160, 120
RATE_HZ = 60
FRAMES = 90
KILLS = 200  # in the study; every so many in ci, as `--share` says
SYNC_S = 0.2
SEAL = re.compile(rb'(\{.*),"crc32":"([0-9a-f]{8})"\}\n', re.DOTALL)


def pose(i):
    return pose_text(rotation(0, 0, 0.001 * i), (0, 0, 0.5 * i))


def source_of(folder, width=WIDTH, height=HEIGHT, frames=FRAMES):
    """A recording at 60 frames/s whose frames all differ, and their pixels."""
    numbers = random.Random(5)
    images = [numbers.randbytes(width * height) for _ in range(frames)]
    path = folder / f"source{width}.mha"
    path.write_bytes(recording("Probe", [i / RATE_HZ for i in range(frames)], [pose(i) for i in range(frames)], images,
                               (width, height)))
    return path, images


def whole_frames(folder):
    """The pixels of every frame that is whole, judged without the program: checksums of lines and of pixels."""
    pixels = (folder / "sweep.raw").read_bytes()
    found = []
    for line in (folder / "sweep.jsonl").read_bytes().splitlines(keepends=True)[1:]:
        seal = SEAL.fullmatch(line)
        if not seal or zlib.crc32(seal.group(1)) != int(seal.group(2), 16):
            continue
        frame = json.loads(line)
        image = pixels[frame["offset"]:frame["offset"] + frame["bytes"]]
        if len(image) == frame["bytes"] and zlib.crc32(image) == int(frame["pixels_crc32"], 16):
            found.append(image)
    return found


def frames_of(folder):
    """The frames that the finished header names."""
    header = (folder / "sweep.mhd").read_text()
    width, height, count = map(int, re.search(r"^DimSize = (\d+) (\d+) (\d+)$", header, re.MULTILINE).groups())
    raw = folder / re.search(r"^ElementDataFile = (\S+)$", header, re.MULTILINE).group(1)
    with open(raw, "rb") as file:
        return header, [file.read(width * height) for _ in range(count)]


def complaint_about_frames(images, source, start=0):
    """Whether `images` are the source's, in its order, from frame `start` on, over and over."""
    for i, image in enumerate(images):
        if image != source[(start + i) % len(source)]:
            return f"frame {i} is not the source's"
    return None


def plain(program, folder, tally):
    path, images = source_of(folder)
    out = folder / "plain"
    replay = f"replay:{path}?speed=2"
    result = program.must_run("record", "--image", replay, "--tracker", replay, "--out", out, "--json").json()
    tally.check("every frame of a replay", (result["frames"], result["dropped_frames"], result["invalid_frames"])
                != (FRAMES, 0, 0) and result)
    tally.check("its duration", abs(result["duration_s"] - (FRAMES - 1) / RATE_HZ / 2) > 1e-3 and result)
    header, recorded = frames_of(out)
    tally.check("bit for bit", complaint_about_frames(recorded, images) or len(recorded) != FRAMES)
    poses = re.findall(r"ProbeToTrackerTransform = (.*)", header)
    wrong = [i for i in range(FRAMES) if [float(x) for x in poses[i].split()] != [float(x) for x in pose(i).split()]]
    tally.check("poses as the tracker gave them", wrong)
    tally.check("latency_applied_s", "latency_applied_s = 0\n" not in header)
    info = program.must_run("info", out, "--json").json()
    tally.check("a folder is a recording", (info["frames"], info["valid_frames"]) != (FRAMES, FRAMES) and info)
    program.must_run("convert", out, folder / "plain.mha")
    program.must_run("exam", "create", folder / "exam", "--recording", out)
    exam = program.must_run("info", folder / "exam", "--json").json()
    tally.check("and goes into an exam", exam["frames"] != FRAMES and exam)
    people = program.must_run("record", "--image", replay, "--frames", 7, "--out", folder / "seven").out
    tally.check("for people", "recorded 7 frames" not in people or "verdict:" not in people)
    found = program.must_run("recover", folder / "seven", "--json").json()
    tally.check("a finished one stays", (found["frames"], found["was_finished"]) != (7, True) and found)


def refused(program, folder, tally):
    path, _ = source_of(folder)
    out = folder / "there"
    out.mkdir()
    (out / "kept").write_text("kept")
    replay = f"replay:{path}"
    empty = folder / "empty"
    empty.mkdir()
    cases = {
        "an existing folder": ["record", "--image", replay, "--out", out],
        "a folder in no folder": ["record", "--image", replay, "--out", folder / "no" / "such"],
        "an unknown source": ["record", "--image", "quantum:0", "--out", folder / "new"],
        "a source that is not there": ["record", "--image", "replay:absent.mha", "--out", folder / "new"],
        "a calibration that is not there": ["record", "--image", replay, "--out", folder / "new", "--calibration", "no"],
        "recover nothing": ["recover", empty],
        "recover a file": ["recover", path],
    }
    before = tree(folder)
    for name, arguments in cases.items():
        complaint = complaint_about_error(program.run(*arguments))
        tally.check(f"refused: {name}", complaint or (tree(folder) != before and "files have changed"))
    user = ordinary_user(program, folder)
    if user is False:
        tally.skip("recording without permission", "the program cannot be run as another user than root here")
        return
    locked = folder / "locked"
    locked.mkdir()
    locked.chmod(0o555)
    outcome = program.run("record", "--image", replay, "--out", locked / "new", user=user)
    tally.check("refused: a folder that cannot be written", complaint_about_error(outcome))


def interrupted(program, folder, tally):
    path, images = source_of(folder)
    out = folder / "interrupted"
    raw = out / "sweep.raw"
    outcome = program.run("record", "--image", f"replay:{path}?loop=1", "--out", out, "--json",
                          interrupt_after=lambda: raw.exists() and raw.stat().st_size > 20 * WIDTH * HEIGHT)
    tally.check("Ctrl-C ends in order", outcome.status != 0 and outcome.err)
    _, recorded = frames_of(out)
    tally.check("all frames until then", len(recorded) < 20 or complaint_about_frames(recorded, images))


def killed(program, folder, tally):
    """SIGKILL at random moments: all that was written comes back, and nothing damaged."""
    path, images = source_of(folder)
    numbers = random.Random(11)
    for i in range(KILLS // program.share):
        out = folder / f"killed{i}"
        child = subprocess.Popen([program.path, "record", "--image", f"replay:{path}?loop=1", "--out", out, "--sync-s",
                                  str(SYNC_S)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        raw = out / "sweep.raw"
        patience_s = time.monotonic() + 60
        while not (raw.exists() and raw.stat().st_size > 0) and time.monotonic() < patience_s:
            time.sleep(0.002)
        time.sleep(numbers.uniform(0, 1.0))
        killed_s = time.monotonic()
        child.send_signal(signal.SIGKILL)
        child.wait()
        if not program.run("info", out).err.count("fathom recover"):
            tally.check("an unfinished folder names recover", "it does not")
        expected = whole_frames(out)
        before = tree(out)
        if not expected:
            tally.check("nothing to recover", complaint_about_error(program.run("recover", out)))
            continue
        found = program.must_run("recover", out, "--json").json()
        _, recorded = frames_of(out)
        complaint = found["frames"] != len(expected) and f"{found} instead of {len(expected)} whole frames"
        complaint = complaint or (recorded != expected and "other frames") or complaint_about_frames(recorded, images)
        tally.check(f"killed after {len(expected)} frames", complaint)
        kept = all(tree(out)[name] == before[name] for name in ("sweep.raw", "sweep.jsonl", "tracker.jsonl"))
        tally.check("the files of the crash stay", not kept and "they were changed")
        last = json.loads((out / "sweep.jsonl").read_bytes().splitlines()[len(expected)])
        if program.share == 1 and not program.sanitized:
            late_s = killed_s - last["time_s"]
            tally.check("every frame older than the last sync", late_s > SYNC_S + 1.0 and f"{late_s:.2f} s are lost")
        shutil.rmtree(out)


def filled(program, folder, tally):
    """A disk of 64 MB that fills up."""
    disk = folder / "disk"
    disk.mkdir()
    mounted = os.geteuid() == 0 and subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=64m", "tmpfs", disk], stderr=subprocess.DEVNULL, check=False).returncode == 0
    if not mounted:
        tally.skip("a disk that fills up", "needs the right to mount a small one; the recorder's own test limits the file")
        return
    try:
        path, images = source_of(folder, 820, 616, 12)
        outcome = program.run("record", "--image", f"replay:{path}?loop=1&speed=4", "--out", disk / "scan", "--json")
        result = outcome.status == 0 and outcome.json()
        tally.check("a full disk ends the recording in order", not result and outcome.err)
        if not result:
            return
        told = [warning for warning in result["warnings"] if "No space left" in warning]
        tally.check("and is told", not told and result["warnings"])
        _, recorded = frames_of(disk / "scan")
        tally.check("what fits is kept", not 110 <= len(recorded) == result["frames"] and len(recorded))
        if not result["dropped_frames"]:
            tally.check("as it came", complaint_about_frames(recorded, images))
        tally.check("and is read", program.must_run("info", disk / "scan", "--json").json()["frames"] != len(recorded))
    finally:
        subprocess.run(["umount", disk], check=True)


def body(program, folder, tally, _root):
    for part in (plain, refused, interrupted, killed, filled):
        own = Path(folder) / part.__name__
        own.mkdir()
        part(program, own, tally)


if __name__ == "__main__":
    run_script(__doc__, body)
