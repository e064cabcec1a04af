"""Damaged volumes, made from good ones. Each case: a name and the files; `fathom convert` must refuse the first one."""

import gzip
import os
import struct
import zlib

from damaged_recordings import MIB, folder, sparse
from recording_file import MetaImage, Nrrd, zeros_stream

SIZES = (7, 6, 5)
VOXELS = struct.pack("<210H", *(i * i % 60013 for i in range(210)))

GOOD_MHA = MetaImage(
    b"ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False\n"
    b"TransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 10 20.5 -30\nCenterOfRotation = 0 0 0\n"
    b"AnatomicalOrientation = RAI\nElementSpacing = 0.3 0.4 1.25\nDimSize = 7 6 5\nElementType = MET_USHORT\n"
    b"ElementDataFile = LOCAL\n" + VOXELS)

GOOD_NRRD = Nrrd(
    b"NRRD0004\ntype: uint16\ndimension: 3\nspace: right-anterior-superior\nsizes: 7 6 5\n"
    b"space directions: (0,0.3,0) (-0.4,0,0) (0,0,1.25)\nkinds: domain domain domain\nendian: little\nencoding: raw\n"
    b"space origin: (10,20.5,-30)\n\n" + VOXELS)


def metaimages(good):
    content = good.bytes()
    header = len(good.header())
    for length in (0, 5, content.index(b"Offset") + 9, content.index(b"ElementDataFile"), header, header + 1,
                   len(content) // 2, len(content) - 1):
        yield f"cut after {length} bytes", {"damaged.mha": content[:length]}
    for key, texts in {
        "DimSize": ("7 6 6", "7 6 0", "7 6 -5", "0 6 5", "7 6 2000000000", "65535 65535 65535", "1024 1024 1025",
                    "4294967296 4294967296 4294967296", "99999999999999999999 6 5", "7 6 five", "nan nan nan", "7 6 5 1",
                    ""),
        "ElementType": ("MET_BANANA", "MET_LONG", "MET_DOUBLE", ""),
        "ElementNumberOfChannels": ("0", "2", "3", "-1", "1000000000"),
        "ElementSpacing": ("nan 0.4 1.25", "0.3 inf 1.25", "0 0.4 1.25", "-0.3 0.4 1.25", "0.3 0.4", "0.3 0.4 1.25 1",
                           "1e300 1e300 1e300", "1e-300 1 1", "a b c", ""),
        "Offset": ("nan 0 0", "0 -inf 0", "0 0", "0 0 0 0", "1e300 0 0", "here", ""),
        "TransformMatrix": ("0 0 0 0 0 0 0 0 0", "1 0 0 1 0 0 0 0 1", "1 0 0 0 1 0 0 0", "1 0 0 0 nan 0 0 0 1",
                            "1e300 0 0 0 1 0 0 0 1", "1 0 0 0 1 0 0 0 1 0 0 0 1", "I", ""),
        "DistanceUnits": ("um", "furlong"),
        "ElementDataFile": ("LIST", "slice%03d.raw 1 5 1", "no_such_file.raw", "../damaged.mha", "/etc/hostname", "."),
    }.items():
        for text in texts:
            yield f"{key} = {text}", {"damaged.mha": good.with_field(key, text).bytes()}
    yield "Offset twice", {"damaged.mha": content.replace(b"Offset", b"Offset = 1 2 3\nOffset", 1)}
    stream = zlib.compress(VOXELS)
    for name, packed in {
        "a stream cut short": stream[:-9],
        "a stream with wrong bytes": stream[:20] + b"\xff" * 9 + stream[29:],
        "a stream with a wrong checksum": stream[:-1] + bytes([stream[-1] ^ 1]),
        "a stream of too little": zlib.compress(VOXELS[:-2]),
        "a stream of too much": zlib.compress(VOXELS + b"\0\0"),
        "a stream of 1.5 GB": zeros_stream(1536 * MIB),
        "no stream": VOXELS,
    }.items():
        yield name, {"damaged.mha": good.compressed(packed).bytes()}
    huge = good.with_field("DimSize", "1024 1024 1025").with_field("ElementType", "MET_UCHAR").with_pixels(b"")
    yield "2^30 voxels and more, all there", {"damaged.mha": sparse(huge.bytes(), 1026 * MIB)}
    yield "2^30 voxels and more, compressed", {
        "damaged.mha": huge.compressed(zeros_stream(1025 * MIB)).bytes()}


def nrrds(good):
    content = good.bytes()
    end = content.index(b"\n\n")
    for length in (6, end // 2, end + 1, end + 2, len(content) // 2, len(content) - 1):
        yield f"cut after {length} bytes", {"damaged.nrrd": content[:length]}
    for key, texts in {
        "sizes": ("7 6 6", "7 6 0", "7 -6 5", "4294967296 4294967296 4294967296", "x y z", "7 6"),
        "dimension": ("0", "2", "4", "-3", "many"),
        "type": ("block", "double", "banana", ""),
        "encoding": ("hex", "bzip2", ""),
        "endian": ("middle",),
        "space": ("nowhere", "right-anterior-superior-time", "RSA"),
        "space directions": ("(0,nan,0) (-0.4,0,0) (0,0,1.25)", "(0,0.3,0) (-0.4,0,0)", "(1,0) (0,1) (1,1)",
                             "(0,0,0) (0,1,0) (0,0,1)", "(1,0,0) (0,1,0) (1,1,0)", "(1e300,0,0) (0,1,0) (0,0,1)",
                             "1 0 0 0 1 0 0 0 1", "(1,0,0 (0,1,0) (0,0,1)"),
        "space origin": ("(nan,0,0)", "(0,0)", "(0,0,0,0)", "(1e300,0,0)", "0 0 0", "(0,0,0) (0,0,0)"),
        "space units": ('"um" "um" "um"', '"mm" "mm" "parsec"'),
    }.items():
        for text in texts:
            yield f"{key}: {text}", {"damaged.nrrd": good.with_line(key, f"{key}: {text}").bytes()}
    bare = good.with_line("space directions", None).with_line("space", None).with_line("space origin", None)
    for text in ("nan 1 1", "1 0 1", "1 1", "1 1 -1", "a b c"):
        yield f"spacings: {text}", {"damaged.nrrd": bare.with_line("spacings", f"spacings: {text}").bytes()}
    packed = good.with_line("encoding", "encoding: gzip")
    stream = gzip.compress(VOXELS)
    yield "gzip, cut short", {"damaged.nrrd": packed.with_pixels(stream[:-9]).bytes()}
    yield "gzip, wrong bytes", {
        "damaged.nrrd": packed.with_pixels(stream[:20] + b"\xff" * 9 + stream[29:]).bytes()}
    yield "gzip, 1.5 GB", {"damaged.nrrd": packed.with_pixels(zeros_stream(1536 * MIB, gzip=True)).bytes()}


def volumes():
    """Every case as (name, files)."""
    for name, files in metaimages(GOOD_MHA):
        yield f"mha volume: {name}", files
    detached = GOOD_MHA.with_field("ElementDataFile", "voxels.raw").with_pixels(b"").bytes()
    yield "mhd volume: without its voxels", {"damaged.mhd": detached}
    yield "mhd volume: a byte short", {"damaged.mhd": detached, "voxels.raw": VOXELS[:-1]}
    yield "mhd volume: a folder as voxels", {"damaged.mhd": detached, "voxels.raw": folder}
    yield "mhd volume: a pipe as voxels", {"damaged.mhd": detached, "voxels.raw": os.mkfifo}
    for name, files in nrrds(GOOD_NRRD):
        yield f"nrrd volume: {name}", files
