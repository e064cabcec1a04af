#!/usr/bin/env python3
"""Damaged files of meshes, held to the same as those of damaged_files."""

from damaged_files import Suite
from program import run_script


def body(program, folder, tally, _root):
    Suite(program, folder, tally).meshes()


if __name__ == "__main__":
    run_script(__doc__, body)
