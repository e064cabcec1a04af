#!/usr/bin/env python3
"""Writes pictures as PNG files of few colours, small enough to be kept beside the text that they belong to.

Usage: small_png.py FILE.png...  makes those that are larger than 250 kB smaller, in place.
"""

import struct
import sys
import zlib
from collections import Counter
from pathlib import Path

LARGEST = 250_000  # bytes
COUNTS = (256, 128, 64, 32)  # of colours, until the file is small enough


class Box:
    """Colours that become one: the mean of them, weighted by how often they occur."""

    def __init__(self, colors):
        self.colors = colors  # ((r, g, b), count)
        self.weight = sum(n for _, n in colors)
        self.mean = tuple(sum(c[k] * n for c, n in colors) / self.weight for k in range(3))
        spread = [sum((c[k] - self.mean[k]) ** 2 * n for c, n in colors) for k in range(3)]
        self.axis = max(range(3), key=lambda k: spread[k])
        self.error = sum(spread) if len(colors) > 1 else 0.0

    def split(self):
        """Across the axis along which its colours differ most."""
        k, middle = self.axis, self.mean[self.axis]
        return [Box(part) for part in ([c for c in self.colors if c[0][k] <= middle],
                                       [c for c in self.colors if c[0][k] > middle])]


def palette_of(counts, size):
    """Boxes of colours, of which each becomes one entry."""
    boxes = [Box(list(counts.items()))]
    while len(boxes) < size:
        worst = max(boxes, key=lambda box: box.error)
        if worst.error == 0.0:
            break
        boxes.remove(worst)
        boxes += worst.split()
    return sorted(boxes, key=lambda box: sum(box.mean))


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def encode(width, height, pixels):
    """`pixels` are bytes of red, green and blue."""
    triples = [pixels[i:i + 3] for i in range(0, len(pixels), 3)]
    counts = Counter(triples)
    for size in COUNTS:
        boxes = palette_of(counts, size)
        index = {color: i for i, box in enumerate(boxes) for color, _ in box.colors}
        places = bytes(index[color] for color in triples)
        rows = b"".join(b"\0" + places[y * width:(y + 1) * width] for y in range(height))
        entries = b"".join(bytes(round(value) for value in box.mean) for box in boxes)
        data = (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0)) +
                chunk(b"PLTE", entries) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))
        if len(data) <= LARGEST:
            break
    return data


def paeth(a, b, c):
    pa, pb, pc = abs(b - c), abs(a - c), abs(a + b - 2 * c)
    return a if pa <= pb and pa <= pc else b if pb <= pc else c


def decode(data):
    """Width, height and pixels of a PNG of 8-bit red, green and blue without interlacing."""
    width, height, depth, kind, _, _, interlaced = struct.unpack(">IIBBBBB", data[16:29])
    if (depth, kind, interlaced) != (8, 2, 0):
        raise ValueError("is no plain picture in 8-bit colours")
    at, packed = 8, b""
    while at < len(data):
        size, name = struct.unpack(">I4s", data[at:at + 8])
        if name == b"IDAT":
            packed += data[at + 8:at + 8 + size]
        at += 12 + size
    raw, line = zlib.decompress(packed), 3 * width
    above, rows = bytearray(line), []
    for y in range(height):
        way, row = raw[y * (line + 1)], bytearray(raw[y * (line + 1) + 1:(y + 1) * (line + 1)])
        for i in range(line if way else 0):
            left, corner = (row[i - 3], above[i - 3]) if i >= 3 else (0, 0)
            guess = (0, left, above[i], (left + above[i]) // 2, paeth(left, above[i], corner))[way]
            row[i] = (row[i] + guess) & 255
        rows.append(bytes(row))
        above = row
    return width, height, b"".join(rows)


def small(data):
    """The bytes of a PNG, or of one of few colours where it would be too large."""
    return data if len(data) <= LARGEST else encode(*decode(data))


def main():
    for name in sys.argv[1:]:
        path = Path(name)
        before = path.read_bytes()
        after = small(before)
        if after != before:
            path.write_bytes(after)
            print(f"{path}: {len(before) // 1000} kB, now {len(after) // 1000} kB")


if __name__ == "__main__":
    main()
