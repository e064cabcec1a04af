#!/usr/bin/env python3
"""Live sources on the command line: what `devices` lists, and what clients of `serve` receive."""

import re
import socket
import struct
import subprocess

from program import complaint_about_error, run_script

WIDTH, HEIGHT, FRAMES = 12, 7, 9


def a_recording(folder):
    fields = []
    for i in range(FRAMES):
        status = "OK" if i != 3 else "INVALID"
        fields += [(f"Seq_Frame{i:04}_ProbeToTrackerTransform", f"1 0 0 {i} 0 1 0 0.1 0 0 1 -2 0 0 0 1"),
                   (f"Seq_Frame{i:04}_ProbeToTrackerTransformStatus", status),
                   (f"Seq_Frame{i:04}_Timestamp", f"{10 + i / 50}")]
    pixels = bytes((7 * i) % 256 for i in range(WIDTH * HEIGHT * FRAMES))
    header = [("ObjectType", "Image"), ("NDims", "3"), ("DimSize", f"{WIDTH} {HEIGHT} {FRAMES}"),
              ("ElementType", "MET_UCHAR"), ("UltrasoundImageOrientation", "MF"), *fields, ("ElementDataFile", "LOCAL")]
    path = folder / "scan.mha"
    path.write_bytes("".join(f"{name} = {value}\n" for name, value in header).encode() + pixels)
    return path, pixels


class Server:
    """`fathom serve` in the background, on a port that it chooses."""

    def __init__(self, program, *arguments):
        self.child = subprocess.Popen([program.path, "serve", *map(str, arguments), "--port", "0", "--json"],
                                      stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        line = self.child.stderr.readline()
        found = re.fullmatch(r"serving on (\S+):(\d+); Ctrl-C ends it\n", line)
        if not found:
            raise AssertionError(f"serve said {line!r}")
        self.address, self.port = found.group(1), int(found.group(2))

    def connect(self):
        return socket.create_connection(("127.0.0.1", self.port), timeout=60)

    def end(self):
        out, err = self.child.communicate(timeout=60)
        return self.child.returncode, out, err


def read_exactly(stream, count):
    data = b""
    while len(data) < count:
        piece = stream.recv(count - len(data))
        if not piece:
            raise EOFError
        data += piece
    return data


def messages(stream):
    """Type, device, stamp and body of each message until the server ends the connection."""
    while True:
        try:
            header = read_exactly(stream, 58)
        except EOFError:
            return
        version, kind, device, stamp, size, _ = struct.unpack(">H12s20sQQQ", header)
        yield (version, kind.rstrip(b"\0").decode(), device.rstrip(b"\0").decode(), stamp / 2**32,
               read_exactly(stream, size))


def served(program, folder, tally):
    path, pixels = a_recording(folder)
    server = Server(program, path, "--once")
    with server.connect() as stream:
        received = list(messages(stream))
    status, out, err = server.end()
    images = [body[72:] for _, kind, _, _, body in received if kind == "IMAGE"]
    tally.check("serve sends every image", b"".join(images) != pixels and f"{len(images)} images")
    poses = [struct.unpack(">12f", body)[9] for _, kind, device, _, body in received
             if (kind, device) == ("TRANSFORM", "ProbeToTracker")]
    tally.check("serve sends every valid pose", poses != [0, 1, 2, 4, 5, 6, 7, 8] and f"{poses}")
    stamps = [stamp for _, kind, _, stamp, _ in received if kind == "IMAGE"]
    wrong = any(abs(b - a - 0.02) > 2e-6 for a, b in zip(stamps, stamps[1:]))
    tally.check("stamps are the recording's", wrong and stamps)
    expected = '{\n "clients": 1,\n "frames": 9,\n "frames_sent": 9,\n "dropped_frames": 0\n}\n'
    tally.check("serve --json", (status, out, err) != (0, expected, "") and f"{status} {out} {err}")
    tally.check("serve waits on the loopback address", server.address != "127.0.0.1" and server.address)


def over_and_over(program, folder, tally):
    server = Server(program, folder / "scan.mha", "--frames", 20)
    with server.connect() as stream:
        count = sum(1 for message in messages(stream) if message[1] == "IMAGE")
    status, out, _ = server.end()
    tally.check("serve plays a recording over and over until --frames", (status, count) != (0, 20) and f"{count} {out}")


def simulated(program, tally):
    server = Server(program, "sim:sphere/linear?frames=5", "--seconds", "0.5", "--device", "Sphere")
    with server.connect() as stream:
        first = next(message for message in messages(stream) if message[1] == "IMAGE")
    status, _, err = server.end()
    wrong = (status, first[2], err) != (0, "Sphere", "")
    tally.check("serve streams a simulated device", wrong and f"{first[:4]} {err}")


def devices(program, tally):
    found = program.must_run("devices", "--json").json()
    kinds = {kind["kind"] for kind in found["kinds"]}
    tally.check("devices knows all kinds", not {"igtl", "replay", "sim", "video"} <= kinds and kinds)
    sources = [device["source"] for device in found["devices"]]
    tally.check("devices finds the simulator", not any(source.startswith("sim:") for source in sources) and sources)
    shown = program.must_run("devices").out
    tally.check("devices shows the same to people", [s for s in sources if s not in shown])


def faults(program, folder, tally):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        outcome = program.run("serve", folder / "scan.mha", "--port", port)
        tally.check("serve on a port that is taken", complaint_about_error(outcome))
    for source in ("missing.mha", "replay:missing.mha", "replay:scan.mha?speed=x", "replay:scan.mha?spede=1",
                   "sim:sphere", "sim:sphere/banana", "igtl:host", "igtl://h:99999", "video:missing.avi",
                   "video:/dev/no-such-video"):
        outcome = program.run("serve", source, "--port", "0", cwd=folder)
        tally.check(f"serve {source}", complaint_about_error(outcome))
    outcome = program.run("serve", "scan.mha", "--port", "0", "--bind", "no.such.host.invalid", cwd=folder)
    tally.check("serve --bind to a host that there is not", complaint_about_error(outcome))
    for line in (["serve"], ["serve", "scan.mha", "--port", "70000"], ["serve", "scan.mha", "--seconds", "0"],
                 ["serve", "scan.mha", "--frames", "0"], ["devices", "x"]):
        status = program.run(*line, cwd=folder).status
        tally.check(" ".join(line), status != 2 and f"status {status}")


def body(program, folder, tally, root):
    served(program, folder, tally)
    over_and_over(program, folder, tally)
    simulated(program, tally)
    devices(program, tally)
    faults(program, folder, tally)


if __name__ == "__main__":
    run_script(__doc__, body)
