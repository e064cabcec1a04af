"""Sequence metafiles as plain bytes, read and written without the program under test."""

import re
import struct
import zlib


class MetaImage:
    """A `.mha` taken apart: header fields in their order, and the bytes after the header."""

    def __init__(self, content):
        end = re.search(rb"^ElementDataFile *=.*\n", content, re.MULTILINE).end()
        lines = content[:end].decode().splitlines()
        self.fields = [tuple(part.strip() for part in line.split("=", 1)) for line in lines]
        self.pixels = content[end:]

    def copy(self):
        other = object.__new__(MetaImage)
        other.fields, other.pixels = list(self.fields), self.pixels
        return other

    def get(self, key):
        return dict(self.fields).get(key)

    def with_field(self, key, value):
        """A copy in which `key` has this value: replaced where it stands, else put before the pixels."""
        other = self.copy()
        if self.get(key) is None:
            other.fields.insert(-1, (key, value))
        else:
            other.fields = [(k, value if k == key else v) for k, v in self.fields]
        return other

    def without(self, pattern):
        """A copy without the fields whose key matches the regular expression."""
        other = self.copy()
        other.fields = [(k, v) for k, v in self.fields if not re.fullmatch(pattern, k)]
        return other

    def with_pixels(self, pixels):
        other = self.copy()
        other.pixels = pixels
        return other

    def compressed(self, stream=None, claimed=None):
        """A copy whose pixels are a zlib stream (of its own pixels, or the one given)."""
        stream = zlib.compress(self.pixels) if stream is None else stream
        other = self.with_field("CompressedData", "True").with_pixels(stream)
        return other.with_field("CompressedDataSize", str(len(stream) if claimed is None else claimed))

    def header(self):
        return "".join(f"{key} = {value}\n" for key, value in self.fields).encode()

    def bytes(self):
        return self.header() + self.pixels


class Nrrd:
    """An attached `.nrrd` taken apart: header lines, and the bytes after the empty line."""

    def __init__(self, content):
        header, self.pixels = content.split(b"\n\n", 1)
        self.lines = header.decode().splitlines()

    def copy(self):
        other = object.__new__(Nrrd)
        other.lines, other.pixels = list(self.lines), self.pixels
        return other

    def get(self, key):
        for line in self.lines:
            match = re.fullmatch(rf"{re.escape(key)}\s*:=?\s*(.*)", line)
            if match:
                return match.group(1)
        return None

    def with_line(self, key, line):
        """A copy in which the line of `key` is another one: replaced, removed (None), or added at the end."""
        other = self.copy()
        kept = [old for old in self.lines if not re.match(rf"{re.escape(key)}\s*:", old)]
        if line is None:
            other.lines = kept
        elif len(kept) == len(self.lines):
            other.lines = kept + [line]
        else:
            other.lines = [line if re.match(rf"{re.escape(key)}\s*:", old) else old for old in self.lines]
        return other

    def with_pixels(self, pixels):
        other = self.copy()
        other.pixels = pixels
        return other

    def bytes(self):
        return ("\n".join(self.lines) + "\n\n").encode() + self.pixels


def zeros_stream(size, gzip=False):
    """A small compressed stream that inflates to `size` zeros (a multiple of 1 MiB), made without deflating them all."""
    block_bytes = 1 << 20
    assert size % block_bytes == 0
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    block = packer.compress(bytes(block_bytes)) + packer.flush(zlib.Z_FULL_FLUSH)
    body = block * (size // block_bytes) + b"\x03\x00"
    if gzip:
        checksum = 0
        for _ in range(size // block_bytes):
            checksum = zlib.crc32(bytes(block_bytes), checksum)
        return b"\x1f\x8b\x08\x00\x00\x00\x00\x00\x00\x03" + body + struct.pack("<II", checksum, size & 0xFFFFFFFF)
    return b"\x78\xda" + body + struct.pack(">HH", size % 65521, 1)  # Adler-32 of zeros
