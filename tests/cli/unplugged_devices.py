#!/usr/bin/env python3
"""Devices that go, or change, in mid-record: the recording ends whole, and is told which device and what to do."""

import json
import os
import random
import re
import socket
import struct
import subprocess
import threading
import time
import tty
from pathlib import Path

from live_recordings import HEIGHT, RATE_HZ, WIDTH, complaint_about_frames, frames_of, pose, source_of
from program import complaint_about_error, run_script
from tracked_recordings import recording

SCANNER_BOX = (30, 8, 100, 96)  # x, y, width, height of what a linear probe shows
DEEPER_BOX = (45, 8, 70, 96)


class Serving:
    """`fathom serve` on a port of the caller's choice."""

    def __init__(self, program, port, recording_file):
        self.child = subprocess.Popen([program.path, "serve", recording_file, "--port", str(port)],
                                      stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        if not self.child.stderr.readline().startswith("serving on"):
            raise AssertionError("serve does not begin")

    def pull(self):
        self.child.kill()
        self.child.communicate()


def free_port():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        return taken.getsockname()[1]


class Record:
    """`fathom record --json` in the background."""

    def __init__(self, program, out, *arguments):
        self.out = out
        self.child = subprocess.Popen([program.path, "record", *map(str, arguments), "--out", out, "--json"],
                                      stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def wait_for(self, frames, width=WIDTH, height=HEIGHT):
        raw, patience_s = self.out / "sweep.raw", time.monotonic() + 60
        while time.monotonic() < patience_s and self.child.poll() is None:
            if raw.exists() and raw.stat().st_size >= frames * width * height:
                return
            time.sleep(0.005)
        if self.child.poll() is None:
            self.child.kill()
        raise AssertionError(f"{frames} frames do not come: {self.child.communicate()}")

    def end(self):
        out, self.err = self.child.communicate(timeout=60)
        return json.loads(out) if self.child.returncode == 0 else {"failed": self.err}


def complaint_about_told(warnings, *texts):
    """Whether one warning has all these texts."""
    told = any(all(text in warning for text in texts) for warning in warnings)
    return not told and f"{texts} is not in {warnings}"


def server_killed(program, folder, tally):
    path, images = source_of(folder)
    port = free_port()
    address = f"igtl://127.0.0.1:{port}"
    first = Serving(program, port, path)
    record = Record(program, folder / "cut", "--image", address, "--frames", 60)
    record.wait_for(20)
    first.pull()
    again = Serving(program, port, path)
    result = record.end()
    again.pull()
    tally.check("a server that is killed: goes on when it is back", result.get("frames") != 60 and result)
    _, recorded = frames_of(folder / "cut")
    tally.check("a server that is killed: its frames are whole", any(image not in images for image in recorded))
    tally.check("a server that is killed: is named", complaint_about_told(result["warnings"], address, "trying again"))

    last = Serving(program, port, path)
    record = Record(program, folder / "gone", "--image", address, "--seconds", 1)
    record.wait_for(10)
    last.pull()
    result = record.end()
    _, recorded = frames_of(folder / "gone")
    wrong = result.get("frames") != len(recorded) or len(recorded) < 10
    tally.check("a server that stays away: what came is kept", wrong and result)
    tally.check("a server that stays away: what to do", complaint_about_told(result["warnings"], address, "check"))
    info = program.must_run("info", folder / "gone", "--json").json()
    tally.check("a server that stays away: is a recording", info["frames"] != len(recorded) and info)


def file_ended(program, folder, tally):
    path, images = source_of(folder)
    replay = f"replay:{path}?speed=3"
    result = program.must_run("record", "--image", replay, "--out", folder / "ended", "--json", "--seconds", 30).json()
    _, recorded = frames_of(folder / "ended")
    wrong = complaint_about_frames(recorded, images) or len(recorded) != len(images)
    tally.check("a file that ends, ends the recording", wrong)
    tally.check("a file that ends: is told", complaint_about_told(result["warnings"], str(path), "ended"))


class Fastrak:
    """An instrument on a pseudo-terminal: what the driver asks of it, and a record every 10 ms."""

    def __init__(self):
        self.ours, theirs = os.openpty()
        tty.setraw(theirs)
        self.name, self.theirs = os.ttyname(theirs), theirs
        self.streaming, self.flags, self.pulled = False, 0x3F2, threading.Event()
        self.threads = [threading.Thread(target=run) for run in (self.listen, self.measure)]
        for thread in self.threads:
            thread.start()

    def write(self, data):
        try:
            os.write(self.ours, data)
        except OSError:
            self.pulled.set()

    def listen(self):
        in_list = False
        while not self.pulled.is_set():
            try:
                heard = os.read(self.ours, 256).decode("latin-1")
            except OSError:
                return
            for letter in heard:
                if in_list or letter == "O":
                    in_list = letter != "\r"
                elif letter in "Cc":
                    self.streaming = letter == "C"
                elif letter == "S":
                    self.write(f"21S{self.flags:3X}    F31  2.4.18{'':32}\r\n".encode())

    def measure(self):
        while not self.pulled.wait(0.01):
            if self.streaming:
                self.write(b"01 " + struct.pack("<7f", 10, 20, 30, 1, 0, 0, 0) + b"\r\n")

    def pull(self):
        self.pulled.set()
        self.threads[1].join()
        os.close(self.theirs)
        os.close(self.ours)
        self.threads[0].join(timeout=5)


def tracker_unplugged(program, folder, tally):
    path, images = source_of(folder)
    instrument = Fastrak()
    tracker = f"polhemus:{instrument.name}"
    record = Record(program, folder / "lost", "--image", f"replay:{path}?loop=1", "--tracker", tracker, "--frames", 150)
    record.wait_for(60)
    instrument.pull()
    result = record.end()
    tally.check("a tracker that is unplugged: images go on", result.get("frames") != 150 and result)
    _, recorded = frames_of(folder / "lost")
    tally.check("a tracker that is unplugged: whole", complaint_about_frames(recorded, images))
    lost = result["invalid_frames"]
    tally.check("a tracker that is unplugged: no frame after has a place", not 30 <= lost <= 100 and result)
    tally.check("a tracker that is unplugged: is named", complaint_about_told(result["warnings"], tracker, "check"))


def speckled(box, count, numbers):
    """Frames of a linear probe."""
    x, y, width, height = box
    noise = bytes(numbers.randrange(40, 200) for _ in range(1 << 14))
    for _ in range(count):
        image = bytearray(WIDTH * HEIGHT)
        for row in range(y, y + height):
            start = numbers.randrange(len(noise) - width)
            image[row * WIDTH + x:row * WIDTH + x + width] = noise[start:start + width]
        yield bytes(image)


def deeper_recording(folder):
    """A scanner that is set to another depth after 100 frames: its file, and its images."""
    numbers = random.Random(8)
    images = [*speckled(SCANNER_BOX, 100, numbers), *speckled(DEEPER_BOX, 110, numbers)]
    path = folder / "deeper.mha"
    path.write_bytes(recording("Probe", [i / RATE_HZ for i in range(len(images))], [pose(i) for i in range(len(images))],
                               images, (WIDTH, HEIGHT)))
    return path, images


def depth_changed(program, folder, tally):
    path, images = deeper_recording(folder)
    record = Record(program, folder / "depth", "--image", f"replay:{path}?speed=2")
    result = record.end()
    fault = result.get("geometry_fault") or ""
    tally.check("another depth: is told", "depth" not in fault and result)
    tally.check("another depth: at once, on the console", "fathom: warning" not in record.err and record.err)
    tally.check("another depth: the shape before", result["image_shape"]["box_px"] != list(SCANNER_BOX) and result)
    header, recorded = frames_of(folder / "depth")
    tally.check("another depth: in the header", f"GeometryFault = {fault}\n" not in header and header[:800])
    tally.check("another depth: every frame is kept", recorded != images)
    invalid = {int(i) for i in re.findall(r"Seq_Frame(\d+)_ImageStatus = INVALID", header)}
    tally.check("another depth: no frame of it is valid", set(range(100, len(images))) - invalid)
    tally.check("another depth: frames well before it are", invalid & set(range(60)))
    info = program.must_run("info", folder / "depth", "--json").json()
    tally.check("another depth: others read it so", not 60 <= info["valid_frames"] <= 100 and info)


def size_changed(program, folder, tally):
    small, images = source_of(folder)
    large, _ = source_of(folder, 200, 150)
    port = free_port()
    server = Serving(program, port, small)
    record = Record(program, folder / "size", "--image", f"igtl://127.0.0.1:{port}")
    record.wait_for(20)
    server.pull()
    server = Serving(program, port, large)
    result = record.end()
    server.pull()
    expected = f"the images changed from {WIDTH}x{HEIGHT} to 200x150 pixels"
    tally.check("another size: is told", result.get("geometry_fault") != expected and result)
    tally.check("another size: ends the recording", complaint_about_told(result["warnings"], "another folder"))
    header, recorded = frames_of(folder / "size")
    wrong = len(recorded) < 20 or any(image not in images for image in recorded)
    tally.check("another size: the frames before are whole", wrong)
    tally.check("another size: in the header", f"GeometryFault = {expected}\n" not in header and header[:800])


def presets(program, folder, tally):
    path, images = source_of(folder)
    preset = {"name": "8 cm", "width": WIDTH, "height": HEIGHT, "depth_mm": 80, "pixel_mm": [0.5, 0.5],
              "crop": [30, 8, 100, 96]}
    other = {**preset, "name": "large", "width": 640, "height": 480}
    file = folder / "presets.json"
    file.write_text(json.dumps({"fathom_image_presets": 1, "presets": [preset, other]}))
    line = ["record", "--image", f"replay:{path}?speed=4", "--presets", file, "--json"]
    program.must_run(*line, "--preset", "8 cm", "--out", folder / "part")
    text = (folder / "part" / "sweep.mhd").read_text()
    raw = (folder / "part" / "sweep.raw").read_bytes()
    tally.check("a preset's part: its size", "DimSize = 100 96 90\n" not in text and text[:300])
    parts = [b"".join(image[(8 + y) * WIDTH + 30:(8 + y) * WIDTH + 130] for y in range(96)) for image in images]
    tally.check("a preset's part: its pixels", raw != b"".join(parts))
    tally.check("a preset's name is kept", "ImagePreset = 8 cm\n" not in text)
    for name, complaint in {"large": "640 x 480", "none": "8 cm, large"}.items():
        outcome = program.run(*line, "--preset", name, "--out", folder / name)
        tally.check(f"preset {name}", complaint_about_error(outcome) or (complaint not in outcome.err and outcome.err))
        tally.check(f"preset {name} leaves nothing", (folder / name).exists())
    tally.check("a preset without a file", program.run("record", "--image", "x", "--out", "y", "--preset", "z").status != 2)


def body(program, folder, tally, _root):
    for part in (server_killed, file_ended, tracker_unplugged, depth_changed, size_changed, presets):
        own = Path(folder) / part.__name__
        own.mkdir()
        part(program, own, tally)


if __name__ == "__main__":
    run_script(__doc__, body)
