"""Runs the fathom program and says what it did: status, output, peak memory, time."""

import argparse
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import dataclass
from pathlib import Path

ERROR_LINE = re.compile(r"fathom: error: [^\n]*\S; \S[^\n]*\n")  # what is wrong; what to do

SKIPPED = 77  # exit status by which ctest knows that nothing could be tested
NOBODY = 65534  # the user of that name on every Linux


@dataclass
class Outcome:
    """One finished run. `status` is negative where a signal ended it, as in subprocess."""

    status: int
    out: str
    err: str
    peak_mb: float
    seconds: float

    def json(self):
        return json.loads(self.out)


class Program:
    """The program under test."""

    def __init__(self, path, sanitized=False, share=1):
        self.path = str(Path(path).resolve())
        self.sanitized = sanitized
        self.share = share  # one case of so many is run, where a script has hundreds of a kind

    def run(self, *arguments, cwd=None, timeout_s=120, user=None, max_file_bytes=None, interrupt_after=None):
        """Runs to the end. `interrupt_after` is a function; once it returns true, the program gets one SIGINT."""

        def prepare():
            signal.signal(signal.SIGINT, signal.SIG_DFL)  # a background job would inherit that it is ignored
            if max_file_bytes is not None:
                resource.setrlimit(resource.RLIMIT_FSIZE, (max_file_bytes, max_file_bytes))
            if user is not None:
                os.setgroups([])
                os.setresgid(user, user, user)
                os.setresuid(user, user, user)

        with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
            began = time.monotonic()
            child = subprocess.Popen([self.path, *map(str, arguments)], cwd=cwd, stdin=subprocess.DEVNULL, stdout=out,
                                     stderr=err, preexec_fn=prepare)
            killer = threading.Timer(timeout_s, child.kill)
            killer.start()
            if interrupt_after is not None:
                while not interrupt_after() and time.monotonic() - began < timeout_s:
                    time.sleep(0.01)
                os.kill(child.pid, signal.SIGINT)  # even a child that ended is not yet waited for
            _, wait_status, usage = os.wait4(child.pid, 0)
            killer.cancel()
            child.returncode = os.waitstatus_to_exitcode(wait_status)
            seconds = time.monotonic() - began
            out.seek(0)
            err.seek(0)
            return Outcome(child.returncode, out.read().decode(errors="replace"), err.read().decode(errors="replace"),
                           usage.ru_maxrss / 1024, seconds)

    def must_run(self, *arguments, **options):
        """Runs what has to succeed."""
        outcome = self.run(*arguments, **options)
        if outcome.status != 0:
            raise AssertionError(f"fathom {' '.join(map(str, arguments))}: status {outcome.status}\n{outcome.err}")
        return outcome


def complaint_about_error(outcome):
    """What is wrong with a run that should have reported one error; None if it is as it should be."""
    if outcome.status != 1:
        return f"status {outcome.status} instead of 1; stderr: {outcome.err[-2000:]!r}"
    if not ERROR_LINE.fullmatch(outcome.err):
        return f"stderr is not one line 'fathom: error: what is wrong; what to do': {outcome.err[-2000:]!r}"
    if any(ord(character) < 32 for character in outcome.err[:-1]):
        return f"the message holds control characters: {outcome.err!r}"
    if len(outcome.err) > 1000:
        return f"the message is {len(outcome.err)} characters long"
    if outcome.out:
        return f"something on standard output: {outcome.out[:200]!r}"
    return None


def ordinary_user(program, folder):
    """A user without root's rights who can run the program: None for oneself, False where there is none."""
    if os.geteuid() != 0:
        return None
    folder.chmod(0o755)
    try:
        return NOBODY if program.run("--version", user=NOBODY).status == 0 else False
    except (OSError, subprocess.SubprocessError):
        return False


class Tally:
    """Counts claims and prints those that do not hold."""

    def __init__(self):
        self.passed = 0
        self.failed = 0
        self.skipped = 0

    def check(self, name, complaint):
        """`complaint` is empty or None where the claim holds."""
        if complaint:
            self.failed += 1
            print(f"FAILED {name}: {complaint}", flush=True)
        else:
            self.passed += 1

    def skip(self, name, reason):
        self.skipped += 1
        print(f"skipped {name}: {reason}", flush=True)

    def finish(self):
        """Prints the summary; returns the exit status."""
        skipped = f", {self.skipped} skipped" if self.skipped else ""
        print(f"{self.passed} passed, {self.failed} failed{skipped}")
        if self.failed or not (self.passed or self.skipped):
            return 1
        return 0 if self.passed else SKIPPED


def tree(folder):
    """Every file under `folder` with its bytes, every folder with None; links and other things by their kind."""
    found = {}
    for path in sorted(Path(folder).rglob("*")):
        name = path.relative_to(folder).as_posix()
        if path.is_symlink():
            found[name] = os.readlink(path)
        elif path.is_file():
            found[name] = path.read_bytes()
        else:
            found[name] = None
    return found


def run_script(description, body, *others):
    """The main program of a script of tests: body(program, folder, tally, root) in a folder of its own, followed by
    the arguments named in `others`."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("fathom", help="the program under test")
    for other in others:
        parser.add_argument(other)
    parser.add_argument("--sanitized", action="store_true", help="built with sanitizers: memory is not measured")
    parser.add_argument("--share", type=int, default=1, metavar="N", help="every Nth of the damaged files only")
    arguments = parser.parse_args()
    folder = Path(tempfile.mkdtemp(prefix="fathom-test-")).resolve()
    tally = Tally()
    try:
        root = Path(__file__).resolve().parents[2]
        body(Program(arguments.fathom, arguments.sanitized, arguments.share), folder, tally, root,
             *(getattr(arguments, other) for other in others))
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    sys.exit(tally.finish())
