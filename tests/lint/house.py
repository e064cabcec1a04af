#!/usr/bin/env python3
"""Checks the rules of the house (CONTRIBUTING.md) that a program can check.

Usage: house.py ROOT. Prints one line for every fault and exits with status 1 if there is any.
"""

import re
import subprocess
import sys
from pathlib import Path

FLOORS = {
    "core": 0,
    "acquisition": 1, "surface": 1,
    "registration": 2,
    "segmentation": 3,
    "measurement": 4,
    "exam": 5, "sim": 5,
    "viewer": 6,
    "cli": 7,
}
MAY_PRINT = {"viewer", "cli", "tests", "benchmarks", "docs"}

INCLUDE = re.compile(r'^\s*#\s*include\s*["<]([^">]+)[">]')
PRINTS = re.compile(r"\bstd::(?:cout|cerr|clog|puts|printf|fprintf)\b|(?<![\w:])(?:puts|printf|fprintf)\s*\(")
# Absolute paths that name somebody's machine.
MACHINE_PATH = re.compile(r"(?<![\w.)\]}$*-])/(?:home|root|work|tmp|Users|mnt)/[\w.-]|\b[A-Z]:\\\\?\w")


def files_of(root):
    """Every file that is tracked or about to be: neither ignored nor in .git."""
    listing = subprocess.run(["git", "-C", str(root), "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
                             check=True, stdout=subprocess.PIPE).stdout
    return sorted({Path(name) for name in listing.decode().split("\0") if name and (root / name).is_file()})


def include_faults(path, lines):
    folder = path.parts[0]
    for number, line in enumerate(lines, 1):
        match = INCLUDE.match(line)
        if not match:
            continue
        quoted, target = '"' in line, match.group(1)
        target_folder = target.split("/")[0]
        if target_folder in FLOORS and not quoted:
            yield number, f"<{target}> is a file of this project; write it in quotes"
        if quoted and "/" not in target:
            yield number, f'"{target}" must be included by its path from the root'
        if folder not in FLOORS or target_folder == folder:
            continue
        if quoted and target_folder not in FLOORS:
            yield number, f'"{target}" is in no folder of the house'
        elif target_folder in FLOORS and FLOORS[target_folder] >= FLOORS[folder]:
            yield number, (f'{folder}/ (floor {FLOORS[folder]}) includes "{target}" '
                           f"(floor {FLOORS[target_folder]}); includes only go down")


def source_faults(root, path, text):
    lines = text.splitlines()
    yield from include_faults(path, lines)
    if path.suffix == ".h" and not text.startswith("#pragma once"):
        yield 1, "a header starts with #pragma once"
    if path.parts[0] in FLOORS and path.parts[0] not in MAY_PRINT:
        for number, line in enumerate(lines, 1):
            if PRINTS.search(line.split("//")[0]):
                yield number, "only cli/ and viewer/ print"
    if path.suffix == ".cpp" and not is_listed(root, path):
        yield 1, "is in no CMakeLists.txt, so nothing builds it"


def is_listed(root, path):
    """Whether a CMakeLists.txt in the file's folder or above names it, by its path from there."""
    for folder in path.parents:
        listing = root / folder / "CMakeLists.txt"
        name = re.escape(path.relative_to(folder).as_posix())
        if listing.is_file() and re.search(rf"(?<![\w./-]){name}(?![\w.-])", listing.read_text(encoding="utf-8")):
            return True
    return False


def faults_in(root, path):
    try:
        text = (root / path).read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return  # a picture or a recording
    if path.suffix in (".h", ".cpp"):
        yield from source_faults(root, path, text)
    for number, line in enumerate(text.splitlines(), 1):
        if MACHINE_PATH.search(line):
            yield number, "names a path of one machine"


def main():
    root = Path(sys.argv[1]).resolve()
    files = files_of(root)
    faults = [f"{path}:{number}: {fault}" for path in files for number, fault in faults_in(root, path)]
    print("\n".join(faults), end="\n" if faults else "")
    print(f"lint: {len(files)} files, {len(faults)} faults against the rules of the house")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
