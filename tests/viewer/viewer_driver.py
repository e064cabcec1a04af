"""Drives the real viewer: `fathom view --script` under an X server of its own, looked at by pictures and dumps."""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import traceback
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path


def skip(why):
    print(f"skipped: {why}")
    sys.exit(77)


class Display:
    """An X server without a screen."""

    def __enter__(self):
        if shutil.which("Xvfb") is None:
            skip("there is no Xvfb (Debian package xvfb)")
        read, write = os.pipe()
        # Without -noreset a client that comes as the last one leaves may find no server.
        self.server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write), "-screen", "0", "1600x1200x24", "-nolisten", "tcp", "-noreset"],
            pass_fds=[write], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as pipe:
            number = pipe.readline().strip()
        if not number:
            raise AssertionError("Xvfb did not start")
        self.name = ":" + number
        return self

    def __exit__(self, *_):
        self.server.terminate()
        self.server.wait()


class Picture:
    """A picture that the viewer took, as a PPM file."""

    def __init__(self, path):
        data = path.read_bytes()
        kind, size, depth, self.pixels = data.split(b"\n", 3)
        assert kind == b"P6" and depth == b"255", f"{path}: {kind} {depth}"
        self.width, self.height = map(int, size.split())
        assert len(self.pixels) == 3 * self.width * self.height

    def at(self, x, y):
        start = 3 * (int(y) * self.width + int(x))
        return tuple(self.pixels[start:start + 3])

    def count(self, wanted):
        """How many pixels are as `wanted(red, green, blue)` says."""
        pixels = self.pixels
        return sum(1 for i in range(0, len(pixels), 3) if wanted(pixels[i], pixels[i + 1], pixels[i + 2]))

    def differs(self, other):
        """How many pixels are not as in the other picture of the same size."""
        assert (self.width, self.height) == (other.width, other.height)
        a, b = self.pixels, other.pixels
        return sum(1 for i in range(0, len(a), 3) if a[i:i + 3] != b[i:i + 3])


class Run:
    """What one run of the viewer left."""

    def __init__(self, folder, process):
        self.folder = folder
        self.code = process.returncode
        self.errors = process.stderr

    def state(self, name="state"):
        return json.loads((self.folder / f"{name}.json").read_text())

    def picture(self, name="picture"):
        return Picture(self.folder / f"{name}.ppm")


class Viewer:
    def __init__(self, program, display, folder):
        self.program, self.display, self.folder = str(Path(program).resolve()), display, Path(folder)
        self.config = self.folder / "config"
        self.runs = 0

    def environment(self):
        return {**os.environ, "DISPLAY": self.display.name, "XDG_CONFIG_HOME": str(self.config),
                "XDG_STATE_HOME": str(self.folder / "state"), "LIBGL_ALWAYS_SOFTWARE": "1"}

    def write(self, events, window=(900, 640)):
        self.runs += 1
        folder = self.folder / f"run{self.runs}"
        folder.mkdir()
        (folder / "script.json").write_text(json.dumps({"window": window, "events": events}))
        return folder

    def run(self, *arguments, events, fails=False, window=(900, 640)):
        """Replays events; what pictures and dumps they make is in the Run."""
        folder = self.write(events, window)
        process = subprocess.run([self.program, "view", *map(str, arguments), "--script", str(folder / "script.json")],
                                 env=self.environment(), cwd=folder, capture_output=True, text=True, timeout=100)
        if not fails:
            assert process.returncode == 0, f"{folder}: {process.stderr}"
        return Run(folder, process)

    def start(self, *arguments, events, window=(900, 640)):
        """The same without waiting for the end."""
        folder = self.write(events, window)
        return folder, subprocess.Popen(
            [self.program, "view", *map(str, arguments), "--script", str(folder / "script.json")],
            env=self.environment(), cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def attempt(scenario, viewer, shared):
    """What went wrong; None where nothing did."""
    began = time.monotonic()
    try:
        scenario(viewer, shared)
        fault = None
    except (AssertionError, KeyError, IndexError, FileNotFoundError, subprocess.TimeoutExpired):
        fault = traceback.format_exc(limit=-2)
    print(f"{'FAILED ' if fault else 'ok     '} {scenario.__name__} ({time.monotonic() - began:.1f} s)", flush=True)
    return fault


def run_all(scenarios, program, prepare, at_once=2):
    """Every scenario in a folder of its own files; prints which failed. `prepare(program, folder)` gives what all use."""
    names = [argument for argument in sys.argv[2:] if not argument.startswith("--")]
    if "--sanitized" in sys.argv:  # the driver's own leaks are not ours, and everything takes ten times as long
        os.environ["ASAN_OPTIONS"] = os.environ.get("ASAN_OPTIONS", "") + ":detect_leaks=0"
        scenarios = scenarios[::6]
    if names:
        scenarios = [scenario for scenario in scenarios if scenario.__name__ in names]
    with tempfile.TemporaryDirectory() as top, Display() as display, ThreadPoolExecutor(at_once) as pool:
        shared = prepare(program, Path(top))
        jobs = []
        for scenario in scenarios:
            folder = Path(top) / scenario.__name__
            folder.mkdir()
            jobs.append(pool.submit(attempt, scenario, Viewer(program, display, folder), shared))
        faults = [job.result() for job in jobs]
    print("\n".join(fault for fault in faults if fault), end="")
    failed = sum(1 for fault in faults if fault)
    print(f"{len(faults) - failed} passed, {failed} failed")
    return 1 if failed else 0


DUMP = {"dump": "state.json"}
IDLE = {"idle": True}


def picture(name="picture", of=None):
    return {"picture": f"{name}.ppm", **({"of": of} if of else {})}


def at(x, y):
    """A pixel of the shown frame."""
    return {"image": [x, y]}
