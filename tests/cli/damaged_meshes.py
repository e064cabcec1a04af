"""Damaged meshes, made from good ones that `fathom convert` wrote. Each case: a name and the files, as in
damaged_recordings; the first file is what `convert` reads."""

import re
import struct

from damaged_recordings import MIB, folder, link_to_itself, pipe, sparse

FORMATS = ("ply", "stl", "obj", "off", "wrl")

# A cube: eight vertices, twelve triangles turned outward.
CUBE = b"""OFF
8 12 0
0 0 0
10 0 0
0 10 0
10 10 0
0 0 10
10 0 10
0 10 10
10 10 10.5
3 0 2 3
3 0 3 1
3 4 5 7
3 4 7 6
3 0 1 5
3 0 5 4
3 2 6 7
3 2 7 3
3 0 4 6
3 0 6 2
3 1 3 7
3 1 7 5
"""


def text_ply(vertices="8", faces="12", index="list uchar int vertex_indices", coordinate="double", body=None):
    lines = CUBE.decode().splitlines()[2:]
    head = ["ply", "format ascii 1.0", f"element vertex {vertices}"]
    head += [f"property {coordinate} {axis}" for axis in "xyz"]
    head += [f"element face {faces}", f"property {index}", "end_header"]
    return ("\n".join(head) + "\n" + ("\n".join(lines) + "\n" if body is None else body)).encode()


def cut_short(good):
    """Not by the last line end alone: nothing is lost with it."""
    yield "empty file", b""
    for length in (1, 3, 4, 17, 60, 83, 84, 85, len(good) // 3, len(good) // 2, len(good) - 20, len(good) - 2):
        yield f"cut to {length} of {len(good)} bytes", good[:length]


def damaged_ply(good):
    counts = ("-1", "7", "9", "2147483647", "2147483648", "4294967304", "18446744073709551616", "eight", "8.0", "")
    for count in counts:
        yield f"{count} vertices", re.sub(rb"element vertex 8", b"element vertex " + count.encode(), good)
        yield f"text of {count} vertices", text_ply(vertices=count)
    for count in ("-1", "13", "2147483647", "99999999999999999999", "many", ""):
        yield f"{count} faces", re.sub(rb"element face 12", b"element face " + count.encode(), good)
        yield f"text of {count} faces", text_ply(faces=count)
    for kind in ("float128", "string", "list", "", "list uchar float"):
        yield f"coordinates of type {kind!r}", text_ply(coordinate=kind)
        yield f"binary coordinates of type {kind!r}", good.replace(b"property double y", f"property {kind} y".encode())
    for index in ("list uchar float vertex_indices", "list float int vertex_indices", "int vertex_indices",
                  "list uchar int strip", "list"):
        yield f"faces of {index}", text_ply(index=index)
    for number in (float("nan"), float("inf"), -float("inf")):
        begin = good.index(b"end_header\n") + len(b"end_header\n")
        yield f"a coordinate of {number}", good[:begin + 8] + struct.pack("<d", number) + good[begin + 16:]
    for index in (8, -1, 2**31 - 1, -2**31):
        yield f"index {index}", good[:-4] + struct.pack("<i", index)
    yield "a face of 255 corners", good[:-13] + b"\xff" + good[-12:]
    yield "more behind the faces", good + b"\0"
    yield "no end of the header", good.replace(b"end_header", b"comment")
    yield "a format to come", good.replace(b"1.0", b"9.9", 1)
    yield "another byte order", good.replace(b"binary_little_endian", b"binary_big_endian")
    yield "a million elements", b"ply\nformat ascii 1.0\n" + b"".join(b"element e%d 0\n" % i for i in range(1_000_000))
    yield "2 GB of header", sparse(b"ply\nformat ascii 1.0\ncomment ", 2048 * MIB)
    body = CUBE.decode().split("\n", 2)[2]
    for wrong in ("nan", "inf", "1e999", "ten", "1,5", "0x10"):
        yield f"text with a coordinate {wrong}", text_ply(body=body.replace("10.5", wrong))
    for wrong in ("8", "-1", "1.5", "1e30", "one"):
        yield f"text with an index {wrong}", text_ply(body=body.replace("3 1 7 5", f"3 1 7 {wrong}"))
    for wrong in ("-3", "4", "2", "1e300", "255"):
        yield f"text with a face of {wrong} corners", text_ply(body=body.replace("3 1 7 5", f"{wrong} 1 7 5"))


def damaged_stl(good):
    for count in (0, 11, 13, 2**31 - 1, 2**32 - 1):
        yield f"{count} triangles", good[:80] + struct.pack("<I", count) + good[84:]
    for number in (float("nan"), float("inf")):
        yield f"a coordinate of {number}", good[:96] + struct.pack("<f", number) + good[100:]
    yield "more behind the triangles", good + b"\0"
    text = b"solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n"
    for length in (7, 30, 60, 75, 90, len(text) - 3):
        yield f"text cut to {length} bytes", text[:length]
    for old, new in ((b"1 0 0", b"1 nan 0"), (b"1 0 0", b"1 0"), (b"1 0 0", b"1 1e999 0"), (b"1 0 0", b"1 one 0"),
                     (b"vertex", b"vortex"), (b"endloop", b"vertex 2 2 2\nendloop"), (b"outer loop", b"inner loop")):
        yield f"text with {new} for {old}", text.replace(old, new, 1)
    yield "2 GB of text", sparse(b"solid ", 2048 * MIB)


def damaged_obj(good):
    last_face = re.findall(rb"f [^\n]*\n", good)[-1]
    for corner in ("9", "0", "-9", "2147483648", "4294967297", "18446744073709551617", "1.5", "nan", "1/", "//1", "a"):
        corner_line = b"f 1 2 " + corner.encode() + b"\n"
        if corner != "1/":  # a texture that is not named is none of ours
            yield f"index {corner}", good.replace(last_face, corner_line)
    for corner in ("1//9", "1//0", "1//x", "1/1/-1"):
        yield f"a normal {corner}", good.replace(last_face, b"f 2 3 " + corner.encode() + b"\n")
    yield "a face of two corners", good.replace(last_face, b"f 1 2\n")
    for wrong in ("nan", "inf", "1e999", "ten", "", "1,5"):
        yield f"a coordinate {wrong!r}", good.replace(b"v 10 10 10.5", b"v 10 10 " + wrong.encode())
    yield "a line of another kind", good.replace(last_face, b"facet 1 2 3\n")
    yield "a line that goes on", good.replace(last_face, b"f 1 2 \\\n3\n")
    yield "2 GB in one line", sparse(b"v 0 0 0\nf 1", 2048 * MIB)


def damaged_off(good):
    for counts in ("-1 12 0", "9 12 0", "8 13 0", "8 11 0", "2147483647 12 0", "8 2147483647 0", "2147483648 12 0",
                   "18446744073709551616 12 0", "8.0 12 0", "eight 12 0", "8", ""):
        yield f"counts {counts!r}", good.replace(b"8 12 0", counts.encode())
    for index in ("8", "-1", "4294967296", "1.5", "nan", ""):
        yield f"index {index!r}", good.replace(b"3 1 7 5", b"3 1 7 " + index.encode())
    for count in ("-3", "4", "2000000000", "99999999999", "three"):
        yield f"a face of {count} corners", good.replace(b"3 1 7 5", count.encode() + b" 1 7 5")
    for wrong in ("nan", "inf", "1e999", "ten", "", "1,5"):
        yield f"a coordinate {wrong!r}", good.replace(b"10 10 10.5", b"10 10 " + wrong.encode())
    yield "binary", good.replace(b"OFF\n", b"OFF BINARY\n")
    yield "of four dimensions", good.replace(b"OFF\n", b"4OFF\n")
    yield "more behind the faces", good + b"3 0 1 2\n"
    yield "2 GB in one line", sparse(b"OFF\n3 1 0\n0 0 0 ", 2048 * MIB)


def damaged_wrl(good):
    for index in ("8", "-2", "4294967296", "1.5", "nan", "{"):
        yield f"index {index}", good.replace(b"1,7,5,", b"1,7," + index.encode() + b",")
    for wrong in ("nan", "inf", "1e999", "ten", "", "]", "10 10"):
        yield f"a coordinate {wrong!r}", good.replace(b"10 10 10.5", b"10 10 " + wrong.encode())
    yield "VRML 1.0", good.replace(b"#VRML V2.0 utf8", b"#VRML V1.0 ascii")
    yield "no faces", good.replace(b"IndexedFaceSet", b"IndexedLineSet")
    yield "no indices", good.replace(b"coordIndex", b"texCoordIndex")
    yield "no coordinates", good.replace(b"coord Coordinate", b"color Color")
    yield "another node as coordinates", good.replace(b"Coordinate {", b"Color {")
    yield "moved", good.replace(b"Shape {", b"Transform { translation 1 2 3 children Shape {") + b"}"
    yield "a bracket too many", good + b"}"
    yield "a text without end", good + b'WorldInfo { title "'
    yield "a million brackets", b"#VRML V2.0 utf8\n" + b"Group{children[" * 1_000_000
    yield "2 GB in one word", sparse(b"#VRML V2.0 utf8\n", 2048 * MIB)


DAMAGES = {"ply": damaged_ply, "stl": damaged_stl, "obj": damaged_obj, "off": damaged_off, "wrl": damaged_wrl}


def meshes(good):
    """Every case as (name, files); `good` holds the bytes of a cube by format."""
    for kind in FORMATS:
        name = f"damaged.{kind}"
        for damages in (cut_short, DAMAGES[kind]):
            for what, damaged in damages(good[kind]):
                if damaged == good[kind]:
                    raise AssertionError(f"{kind}: {what} damages nothing")
                yield f"{kind}: {what}", {name: damaged}
        yield f"{kind}: not there", {}
        yield f"{kind}: a folder", {name: folder}
        yield f"{kind}: a pipe", {name: pipe}
        yield f"{kind}: a link to itself", {name: link_to_itself}
        yield f"{kind}: rubbish", {name: bytes((i * i * 7 + i // 3) & 255 for i in range(100_000))}
        yield f"{kind}: a picture", {name: b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR" + bytes(100)}
        yield f"{kind}: a text", {name: b"Dear colleague,\nhere is the mesh.\n"}
        yield f"{kind}: 2 GB of zeros", {name: sparse(b"", 2048 * MIB)}
        for other in FORMATS:
            if other != kind:
                yield f"{kind}: in truth {other}", {name: good[other]}
        yield f"{kind}: a name with a line break", {f"damaged\nfathom: error: x; y.{kind}": b""}
