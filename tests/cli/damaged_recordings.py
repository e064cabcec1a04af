"""Damaged recordings, made from good ones. Each case: a name, the files, and the commands that must refuse them.

The files are {name: bytes or a function that makes the file at the path it is given}; the first one is what the commands
read. Faults of the header must be found by every command (`info` and one other, in turn, are tried), those of the pixels
by the commands that read pixels.
"""

import gzip
import itertools
import os
import re
import zlib

from recording_file import zeros_stream

EVERY = ("info", "measure", "segment", "convert")
HEADER = None  # any command: chosen in turn
PIXELS = ("segment", "convert")
POSES = ("measure",)
OUTLINES = ("segment",)

MIB = 1 << 20


def sparse(head, size):
    """A file that starts with `head` and is zeros from there to `size`, without room on disk."""

    def make(path):
        path.write_bytes(head)
        os.truncate(path, size)

    return make


def folder(path):
    path.mkdir()


def pipe(path):
    os.mkfifo(path)


def link_to_itself(path):
    path.symlink_to(path.name)


def many_fields(path):
    """A header of 60 MB in small fields, cut before its end."""
    head = b"ObjectType = Image\nNDims = 3\nDimSize = 1 1 9\nElementType = MET_UCHAR\n"
    path.write_bytes(head + b"".join(b"k%d = %d\n" % (number, number) for number in range(3_500_000)))


def cut_short(good):
    content = good.bytes()
    header = len(good.header())
    pose = content.index(b"Seq_Frame0003_ProbeToTrackerTransform =")
    dim = content.index(b"DimSize")
    yield "empty file", b""
    yield "cut in the first line", content[:7]
    yield "cut after the first line", content[: content.index(b"\n") + 1]
    yield "cut inside DimSize", content[: dim + 11]
    yield "cut in the middle of a pose", content[: pose + 70]
    yield "cut in the name of a field", content[: pose + 15]
    yield "cut before ElementDataFile", content[: content.index(b"ElementDataFile")]
    yield "cut after the header", content[:header]
    yield "cut in the first frame", content[: header + 1000]
    yield "cut in the middle of the pixels", content[: header + len(good.pixels) // 2]
    yield "one byte short", content[:-1]


def wrong_header(good):
    frames = int(good.get("DimSize").split()[2])
    for text in (f"330 420 {frames + 1}", "330 420 1000000000", "330 0 6", "0 420 6", "-330 420 6", "330 420 -6",
                 "-330 -420 6", "4294967296 4294967296 4294967296", "4294967626 420 6", "65536 65536 65536",
                 "18446744073709551615 2 6", "99999999999999999999999 420 6", "2147483647 2147483647 2", "330 420",
                 "330", "", "330 420 6 1", "330 420 six", "330.5 420 6", "nan nan nan", "0 0 2000000000"):
        yield f"DimSize = {text}", good.with_field("DimSize", text)
    for text in ("0", "-3", "1", "4", "99999999999", "three", ""):
        yield f"NDims = {text}", good.with_field("NDims", text)
    for text in ("MET_BANANA", "MET_FLOAT_ARRAY", "MET_LONG_LONG", "", "MET_USHORT"):
        yield f"ElementType = {text}", good.with_field("ElementType", text)
    for text in ("0", "-1", "3", "1000000000", "99999999999999999999", "x"):
        yield f"ElementNumberOfChannels = {text}", good.with_field("ElementNumberOfChannels", text)
    for text in ("XY", "MFAX", "AMF", "FM", "?"):
        yield f"UltrasoundImageOrientation = {text}", good.with_field("UltrasoundImageOrientation", text)
    for text in ("LIST", "frame%03d.raw 1 6 1", "no_such_file.raw", "", ".", "../good.raw", "/etc/hostname",
                 "sub/../../good.raw", "a\0b.raw"):
        yield f"ElementDataFile = {text!r}", good.with_field("ElementDataFile", text).with_pixels(b"")
    yield "a pixel file that is the header itself", good.with_field("ElementDataFile", "damaged.mha").with_pixels(b"")
    yield "pixels as text", good.with_field("BinaryData", "False")
    yield "a pixel file with a negative header", good.with_field("HeaderSize", "-7")
    yield "a pixel file with a huge header", good.with_field("HeaderSize", "9223372036854775807")
    for key in ("DimSize", "ElementType", "ElementDataFile"):
        yield f"no {key}", good.without(key)
    yield "DimSize twice", good.bytes().replace(b"DimSize", b"DimSize = 330 420 5\nDimSize", 1)
    yield "another object type", good.with_field("ObjectType", "Mesh")
    yield "a line without '='", good.bytes().replace(b"NDims = 3", b"NDims = 3\nthis line says nothing", 1)


def wrong_poses(good):
    key = "Seq_Frame0002_ProbeToTrackerTransform"
    numbers = good.get(key).split()

    def pose(*changes):
        changed = list(numbers)
        for index, value in changes:
            changed[index] = str(value)
        return good.with_field(key, " ".join(changed))

    yield "a pose with NaN", pose((0, "nan"))
    yield "a pose with -nan(ind)", pose((3, "-nan(ind)"))
    yield "a pose with infinity", pose((7, "inf"))
    yield "a pose beyond all numbers", pose((7, "1e999"))
    yield "a pose with a word", pose((5, "left"))
    yield "a pose with a decimal comma", pose((3, "1,5"))
    yield "a pose of 15 numbers", good.with_field(key, " ".join(numbers[:15]))
    yield "a pose of 17 numbers", good.with_field(key, " ".join(numbers + ["1"]))
    yield "an empty pose", good.with_field(key, "")
    yield "a pose of zeros", good.with_field(key, " ".join(["0"] * 16))
    yield "a pose whose last row is not 0 0 0 1", pose((12, 0.5))
    yield "a pose whose last number is 2", pose((15, 2))
    yield "a pose that scales", pose(*((i, 1.01 * float(numbers[i])) for i in (0, 1, 2, 4, 5, 6, 8, 9, 10)))
    yield "a pose that shears", pose(*((i, float(numbers[i]) + 0.01 * float(numbers[i - 1])) for i in (1, 5, 9)))
    yield "a mirrored pose", pose(*((i, -float(numbers[i])) for i in (0, 4, 8)))
    yield "a rotation of 1e200", pose((0, 1e200))
    yield "a frame twice", good.with_pixels(good.pixels).bytes().replace(
        b"ElementDataFile", f"{key} = {' '.join(numbers)}\nElementDataFile".encode(), 1)
    yield "a frame beyond the last", good.with_field("Seq_Frame0006_Timestamp", "1.5")
    yield "a frame number beyond all numbers", good.with_field("Seq_Frame99999999999999999999_Timestamp", "1.5")
    yield "a negative frame number", good.with_field("Seq_Frame-001_Timestamp", "1.5")
    for text in ("nan", "inf", "noon", "1e999", ""):
        yield f"a time stamp {text!r}", good.with_field("Seq_Frame0002_Timestamp", text)


def damaged_streams(good):
    stream = zlib.compress(good.pixels)
    half = len(stream) // 2
    yield "a stream longer than the file", HEADER, good.compressed(claimed=len(stream) + 1)
    yield "a stream of 2^63 bytes", HEADER, good.compressed(claimed=1 << 63)
    yield "a stream of -1 bytes", HEADER, good.compressed(claimed=-1)
    yield "a stream of no bytes", HEADER, good.compressed(stream=b"")
    yield "a stream cut short by the file's end", HEADER, good.compressed(stream[:half], claimed=len(stream))
    yield "a stream cut short", PIXELS, good.compressed(stream[:half])
    yield "a stream cut by its last byte", PIXELS, good.compressed(stream[:-1])
    yield "a stream with a wrong checksum", PIXELS, good.compressed(stream[:-1] + bytes([stream[-1] ^ 1]))
    yield "a stream with wrong bytes", PIXELS, good.compressed(stream[:half] + b"\xff" * 40 + stream[half + 40:])
    yield "rubbish instead of a stream", PIXELS, good.compressed(bytes(range(1, 256)) * 20)
    yield "pixels that claim to be compressed", PIXELS, good.compressed(good.pixels)
    yield "a stream of fewer frames", PIXELS, good.compressed(zlib.compress(good.pixels[: 330 * 420 * 4]))
    yield "a stream of one byte less", PIXELS, good.compressed(zlib.compress(good.pixels[:-1]))
    yield "a stream of more frames", PIXELS, good.compressed(zlib.compress(good.pixels + good.pixels))
    yield "a small stream that claims 100 GB", HEADER, good.with_field("DimSize", "330 420 721500").compressed()
    yield "one frame that inflates to 400 MB", HEADER, (
        good.without("Seq_.*").with_field("DimSize", "20480 20480 1").compressed(zeros_stream(400 * MIB)))
    yield "six small frames that inflate to 1.5 GB", PIXELS, good.compressed(zeros_stream(1536 * MIB))


def damaged_detached(good):
    """A header with its pixels in another file."""
    head = good.with_field("ElementDataFile", "pixels.raw").with_pixels(b"").bytes()
    yield "without its pixel file", {"damaged.mhd": head}
    yield "with an empty pixel file", {"damaged.mhd": head, "pixels.raw": b""}
    yield "with a pixel file cut short", {"damaged.mhd": head, "pixels.raw": good.pixels[:-1]}
    yield "with a folder as pixel file", {"damaged.mhd": head, "pixels.raw": folder}
    yield "with a pipe as pixel file", {"damaged.mhd": head, "pixels.raw": pipe}
    yield "with a link to itself as pixel file", {"damaged.mhd": head, "pixels.raw": link_to_itself}
    yield "cut in the middle of a pose", {"damaged.mhd": head[: len(head) // 2], "pixels.raw": good.pixels}


def damaged_nrrds(good):
    content = good.bytes()
    end = content.index(b"\n\n")
    # Kept raw here, so that faults of the header and of the pixels do not mix.
    key = next(line for line in good.lines if "Frame0002_ProbeToTrackerTransform" in line).split(":")[0]
    yield "cut in the magic", HEADER, content[:6]
    yield "cut after the magic", HEADER, content[:9]
    yield "cut in the header", HEADER, content[: end // 2]
    yield "cut at the header's end", HEADER, content[: end + 1]
    yield "without pixels", HEADER, content[: end + 2]
    yield "cut in the pixels", HEADER, content[: len(content) - 330 * 420]
    yield "one byte short", HEADER, content[:-1]
    yield "of a version to come", HEADER, b"NRRD0009" + content[8:]
    for text in ("330 420 7", "330 -420 6", "330 420", "0 420 6", "4294967296 4294967296 4294967296", "x y z",
                 "99999999999999999999 420 6"):
        yield f"sizes: {text}", HEADER, good.with_line("sizes", f"sizes: {text}")
    for text in ("0", "-3", "16", "9999999999", "many"):
        yield f"dimension: {text}", HEADER, good.with_line("dimension", f"dimension: {text}")
    for text in ("block", "banana", "int64", ""):
        yield f"type: {text}", HEADER, good.with_line("type", f"type: {text}")
    for text in ("bzip2", "hex", "text", "zstd", ""):
        yield f"encoding: {text}", HEADER, good.with_line("encoding", f"encoding: {text}")
    for missing in ("sizes", "dimension", "type", "encoding"):
        yield f"no {missing}", HEADER, good.with_line(missing, None)
    yield "a data file elsewhere", HEADER, good.with_line("data file", "data file: ../good.raw")
    yield "a pose with NaN", HEADER, good.with_line(key, re.sub(r":=\S+", ":=nan", f"{key}:={good.get(key)}"))
    yield "a pose of 3 numbers", HEADER, good.with_line(key, f"{key}:=1 2 3")
    yield "a frame twice", HEADER, good.copy().bytes().replace(b"\n\n", f"\n{key}:={good.get(key)}\n\n".encode(), 1)

    packed = good.with_line("encoding", "encoding: gzip")
    stream = gzip.compress(good.pixels)
    half = len(stream) // 2
    yield "gzip, cut short", PIXELS, packed.with_pixels(stream[:half])
    yield "gzip, without its checksum", PIXELS, packed.with_pixels(stream[:-8])
    yield "gzip, wrong checksum", PIXELS, packed.with_pixels(stream[:-6] + b"\0\0" + stream[-4:])
    yield "gzip, wrong bytes", PIXELS, packed.with_pixels(stream[:half] + b"\xff" * 40 + stream[half + 40:])
    yield "gzip, no stream at all", PIXELS, packed.with_pixels(b"not a stream")
    yield "gzip, empty", PIXELS, packed.with_pixels(b"")
    yield "gzip, 1.5 GB for six small frames", PIXELS, packed.with_pixels(zeros_stream(1536 * MIB, gzip=True))
    yield "gzip, a claim of 100 GB", HEADER, packed.with_line("sizes", "sizes: 330 420 721500").with_pixels(stream)


def recordings(good_mha, good_nrrd):
    """Every case as (name, files, commands)."""

    def data(damaged):
        return damaged if isinstance(damaged, bytes) else damaged.bytes()

    every_other = itertools.cycle(EVERY[1:])

    def header():
        return "info", next(every_other)

    for damages in (cut_short, wrong_header, wrong_poses):
        for name, damaged in damages(good_mha):
            yield f"mha: {name}", {"damaged.mha": data(damaged)}, header()
    for name, commands, damaged in damaged_streams(good_mha):
        yield f"mha: {name}", {"damaged.mha": data(damaged)}, commands or header()
    for name, files in damaged_detached(good_mha):
        yield f"mhd: {name}", files, EVERY
    for name, commands, damaged in damaged_nrrds(good_nrrd):
        yield f"nrrd: {name}", {"damaged.nrrd": data(damaged)}, commands or header()

    yield "mha: no poses at all", {"damaged.mha": data(good_mha.without("Seq_.*Transform.*"))}, POSES
    yield "mha: poses of another tool", {
        "damaged.mha": data(good_mha).replace(b"ProbeToTracker", b"StylusToTracker")}, POSES
    yield "mha: poses only", {
        "damaged.mha": data(good_mha.with_field("DimSize", "0 0 6").with_pixels(b""))}, OUTLINES

    yield "a recording that is not there", {}, EVERY
    yield "a folder instead of a recording", {"damaged.mha": folder}, EVERY
    yield "a pipe instead of a recording", {"damaged.mha": pipe}, EVERY
    yield "a link to itself", {"damaged.mha": link_to_itself}, EVERY
    yield "rubbish", {"damaged.mha": bytes((i * i * 7 + i // 3) & 255 for i in range(100_000))}, EVERY
    yield "a picture", {"damaged.mha": b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR" + bytes(100)}, EVERY
    yield "a text", {"damaged.mha": b"Dear colleague,\nhere is the scan.\n"}, EVERY
    yield "2 GB of zeros", {"damaged.mha": sparse(b"", 2048 * MIB)}, EVERY
    yield "a header line of 600 MB", {
        "damaged.mha": sparse(b"ObjectType = Image\nNDims = 3\nComment = ", 600 * MIB)}, EVERY
    yield "a header line of 600 MB in a nrrd", {"damaged.nrrd": sparse(b"NRRD0004\n# ", 600 * MIB)}, EVERY
    yield "a header of 3.5 million fields", {"damaged.mha": many_fields}, ("info",)
    yield "a name with a line break", {"damaged\nfathom: error: x; y.mha": b""}, EVERY
