#!/usr/bin/env python3
"""What users type and what other programs read: help, statuses, JSON keys, and the way from scan to volume."""

import json
import os
import re
import subprocess
import zlib

from program import complaint_about_error, run_script, tree
from recording_file import MetaImage

COMMANDS = ("accuracy", "info", "convert", "simulate", "segment", "sweeps", "planes", "measure",
            "surface", "reslice", "reconstruct", "isosurface", "eqnsurf", "calibrate", "register", "demo",
            "devices", "serve", "record", "recover", "propagate", "view")
METHODS = {"linear_planimetry", "cubic_planimetry", "cubic_planimetry_3d", "cubic_planimetry_quadric", "shape_based",
           "centroid_guided", "disc_guided", "disc_guided_curved"}
SIMULATE = ("simulate", "--object", "sphere", "--pattern", "linear")


def without(keys, document):
    missing = sorted(set(keys) - set(document))
    return missing and f"keys missing: {missing}"


def off(found, expected, tolerance):
    """A complaint if `found` is not `expected` within a relative tolerance."""
    if found is None or abs(found - expected) > tolerance * abs(expected):
        return f"{found} instead of {expected} (within {tolerance:g})"
    return None


def help_and_version(program, folder, tally):
    for arguments in (["--help"], *([command, "--help"] for command in COMMANDS)):
        outcome = program.run(*arguments, cwd=folder)
        wrong = outcome.status != 0 or outcome.err or len(outcome.out.splitlines()) < 3
        tally.check(" ".join(arguments), wrong and f"{outcome}")
    overview = program.run("--help").out
    tally.check("--help names every command", [c for c in COMMANDS if c not in overview])
    outcome = program.run("--version")
    wrong = outcome.status != 0 or not re.fullmatch(r"fathom \d+\.\d+\.\d+\n", outcome.out)
    tally.check("--version", wrong and f"{outcome}")


def wrong_command_lines(program, folder, tally):
    empty = folder / "empty"
    empty.mkdir()
    lines = (
        "", "measur", "--json", "info", "info a.mha b.mha", "info a.mha --verbose-please", "info --probe-frame",
        "calibrate", "calibrate banana", "calibrate pivot", "calibrate pivot a.mha --max-rms-mm 0", "calibrate temporal",
        "calibrate temporal --image a.mha --max-latency-s 11", "calibrate temporal --image a.mha --calibration c.json",
        "register", "register landmarks --to b.csv", "register landmarks --from a.csv --to b.csv --tolerance-mm nan",
        "convert a.mha", "simulate --object sphere --pattern linear --frames 5",
        "simulate --object sphere --pattern linear --out s.mha", "simulate --pattern linear --frames 5 --out s.mha",
        "simulate --object banana --pattern linear --frames 5 --out s.mha",
        "simulate --object sphere --pattern zigzag --frames 5 --out s.mha",
        "simulate --object sphere --pattern linear --frames 0 --out s.mha",
        "simulate --object sphere --pattern linear --frames -3 --out s.mha",
        "simulate --object sphere --pattern linear --frames many --out s.mha",
        "simulate --object sphere --pattern linear --frames 5.5 --out s.mha",
        "simulate --object sphere --pattern linear --frames 99999999999999999999 --out s.mha",
        "simulate --object sphere --pattern linear --frames 5 --seed x --out s.mha",
        "simulate --object sphere --pattern linear --frames 5 --noise-mm -1 --out s.mha",
        "simulate --object sphere --pattern linear --frames 5 --noise-mm nan --out s.mha",
        "segment a.mha --out c.json", "segment a.mha --threshold high --out c.json", "segment a.mha --threshold 128",
        "simulate --object sphere --pattern linear --frames 5 --noise-mm 1e9 --out s.mha",
        "simulate --object sphere --pattern linear --frames 5 --jitter-deg 181 --out s.mha",
        "simulate --object sphere --pattern linear --frames 5 --latency-s nan --out s.mha",
        "simulate --object sphere --pattern linear --frames 5 --seed -1 --out s.mha",
        "simulate --object sphere --pattern linear --frames 5 --seed 18446744073709551616 --out s.mha",
        "segment a.mha --threshold nan --out c.json", "segment a.mha --threshold 128 --structure= --out c.json",
        "segment a.mha --threshold 128 --every 0 --out c.json", "measure a.mha", "measure a.mha --calibration c.json",
        "measure a.mha --contours c.json", "reslice a.mha",
        "reslice a.mha --calibration c.json --through-frame 3", "reslice a.mha --calibration c.json --out p.png", "demo --out", "demo --frames-per-second-please 3",
    )
    for line in lines:
        outcome = program.run(*line.split(), cwd=empty)
        wrong = outcome.status != 2 or outcome.out or not outcome.err
        tally.check(f"fathom {line}", wrong and f"{outcome}")
        tally.check(f"fathom {line} writes nothing", sorted(tree(empty)))


def scan_to_volume(program, folder, tally):
    scan = folder / "sphere.mha"
    made = program.must_run(*SIMULATE, "--frames", 120, "--out", scan, "--json").json()
    tally.check("simulate's keys", without({"volume_ml", "surface_area_cm2", "structures"}, made))
    tally.check("simulate's structures", [without({"name", "volume_ml"}, s) for s in made["structures"]
                                          if without({"name", "volume_ml"}, s)])
    calibration, outlines = folder / "sphere.calibration.json", folder / "sphere.contours.json"
    truth = json.loads((folder / "sphere.truth.json").read_text())
    tally.check("the truth file's keys", without({"volume_ml", "surface_area_cm2", "structures", "latency_s"}, truth))
    tally.check("the truth file's volume", off(truth["volume_ml"], made["volume_ml"], 1e-9))
    # A sphere of 2 cm, or whatever fits that cube: volume and area must belong to one radius.
    radius_cm = (3 * made["volume_ml"] / (4 * 3.14159265358979)) ** (1 / 3)
    tally.check("a sphere's area", off(made["surface_area_cm2"], 4 * 3.14159265358979 * radius_cm**2, 1e-6))

    info = program.must_run("info", scan, "--json").json()
    tally.check("info's keys", without({"frames", "valid_frames", "width", "height", "pixel_type", "duration_s",
                                        "frame_rate_hz", "transforms"}, info))
    header = MetaImage(scan.read_bytes())
    width, height, frames = map(int, header.get("DimSize").split())
    tally.check("info's sizes", (info["frames"], info["valid_frames"], info["width"], info["height"]) !=
                (frames, frames, width, height) and f"{info}")
    tally.check("120 frames", frames != 120 and frames)

    def measured(contours):
        outcome = program.must_run("measure", scan, "--calibration", calibration, "--contours", contours, "--json")
        return outcome.json()["structures"]

    true_outlines = measured(outlines)
    tally.check("one structure", len(true_outlines) != 1 and f"{len(true_outlines)}")
    tally.check("measure's keys", without({"name", "sections", "volume_ml", "recommended", "volume_interval_ml",
                                           "volume_interval_parts_ml", "where_next", "missing_ends", "partitions",
                                           "warnings", "seconds"}, true_outlines[0]))
    low, high = true_outlines[0]["volume_interval_ml"]
    tally.check("the interval holds the truth", not low <= made["volume_ml"] <= high and (low, high))
    tally.check("measure's methods", set(true_outlines[0]["volume_ml"]) ^ METHODS)
    for method in ("linear_planimetry", "cubic_planimetry", "cubic_planimetry_3d"):
        tally.check(f"{method} of true outlines", off(true_outlines[0]["volume_ml"][method], made["volume_ml"], 0.001))

    found = program.must_run("segment", scan, "--threshold", 128, "--structure", "ball", "--out", folder / "by.json",
                             "--json").json()
    tally.check("segment's keys", without({"contours", "frames"}, found))
    document = json.loads((folder / "by.json").read_text())
    tally.check("the contours file", document["fathom_contours"] != 1 and document["fathom_contours"])
    tally.check("as many contours as said", len(document["structures"][0]["contours"]) != found["contours"] and found)
    by_threshold = measured(folder / "by.json")
    tally.check("the structure's name", by_threshold[0]["name"] != "ball" and by_threshold[0]["name"])
    for method in ("linear_planimetry", "cubic_planimetry", "cubic_planimetry_3d"):
        tally.check(f"{method} of outlines by threshold",
                    off(by_threshold[0]["volume_ml"][method], made["volume_ml"], 0.003))

    program.must_run("segment", scan, "--threshold", 128, "--every", 10, "--out", folder / "tenth.json")
    tenth = json.loads((folder / "tenth.json").read_text())["structures"][0]["contours"]
    steps = {b["frame"] - a["frame"] for a, b in zip(tenth, tenth[1:])}
    tally.check("every tenth frame", steps != {10} and f"steps of {steps}")
    table = program.must_run("measure", scan, "--calibration", calibration, "--contours", outlines).out
    tally.check("a table for people", "ml" not in table and table)


def propagation(program, folder, tally):
    """From outlines on some frames to all between; drawn ones stay, and a gap that leads nowhere is refused."""
    scan, truth, drawn, filled = (folder / name for name in ("few.mha", "few.contours.json", "drawn.json", "all.json"))
    program.must_run("simulate", "--object", "bladder", "--pattern", "linear", "--frames", 17, "--speckle", "--out", scan)
    document = json.loads(truth.read_text())
    structure = document["structures"][0]
    structure["contours"] = [c for c in structure["contours"] if c["frame"] % 4 == 0 and "points" in c]
    drawn.write_text(json.dumps(document))
    found = program.must_run("propagate", scan, "--contours", drawn, "--calibration", folder / "few.calibration.json",
                             "--out", filled, "--picture", folder / "all.png", "--json").json()
    tally.check("propagate's keys", without({"contours", "confidence"}, found))
    after = json.loads(filled.read_text())["structures"][0]["contours"]
    tally.check("drawn contours stay", [c for c in after if "confidence" not in c] != structure["contours"] and "they changed")
    tally.check("frames between are filled", found["contours"] != len(after) - len(structure["contours"]) and f"{found}")
    tally.check("the picture is there", not (folder / "all.png").read_bytes().startswith(b"\x89PNG") and "it is not")
    structure["contours"] = structure["contours"][:1]
    drawn.write_text(json.dumps({"fathom_contours": 1, "structures": [
        {"name": "bladder", "contours": structure["contours"]}]}))
    filled.unlink()
    outcome = program.run("propagate", scan, "--contours", drawn, "--out", filled)
    wrong = outcome.status != 1 or filled.exists() or "at least two frames" not in outcome.err
    tally.check("one outlined frame leads nowhere", wrong and f"{outcome}")


def seeds(program, folder, tally):
    def scanned(name, seed, *options):
        out = folder / name
        out.mkdir()
        program.must_run(*SIMULATE, "--frames", 5, "--seed", seed, *options, "--out", out / "s.mha")
        return tree(out)

    noisy = ("--jitter-mm", 0.5, "--noise-mm", 0.25, "--noise-deg", 0.15)
    first, second, third = (scanned(f"seed{i}", seed, *noisy) for i, seed in enumerate((7, 7, 8)))
    tally.check("four files", set(first) ^ {"s.mha", "s.calibration.json", "s.truth.json", "s.contours.json"})
    tally.check("same seed, same bytes", [name for name in first if first[name] != second[name]])
    tally.check("another seed, other poses", first["s.mha"] == third["s.mha"] and "the recording is the same")


def round_trips(program, folder, tally):
    scan = folder / "trip.mha"
    program.must_run(*SIMULATE, "--frames", 7, "--noise-mm", 0.3, "--seed", 5, "--out", scan)
    original = MetaImage(scan.read_bytes())

    def frame_fields(recording):
        return {key: value for key, value in recording.fields if key.startswith("Seq_Frame")}

    for steps in (["a.mha"], ["a.nrrd", "b.mha"], ["a.mhd", "b.mha"], ["a.nrrd", "b.mhd", "c.nrrd", "d.mha"]):
        for options in ([], ["--compress"]):
            source = scan
            out = folder / "-".join(["trip", *steps, *options])
            out.mkdir()
            for step in steps:
                program.must_run("convert", *options, source, out / step)
                source = out / step
            result = MetaImage(source.read_bytes())
            name = " -> ".join(["mha", *steps, *options])
            pixels = zlib.decompress(result.pixels) if options else result.pixels
            tally.check(f"{name}: pixels", pixels != original.pixels and "differ")
            tally.check(f"{name}: frame fields", frame_fields(result) != frame_fields(original) and "differ")
            tally.check(f"{name}: only these files", len(tree(out)) != len(steps) + sum(
                step.endswith(".mhd") for step in steps) and sorted(tree(out)))


def demo(program, folder, tally):
    cwd = folder / "demo"
    cwd.mkdir()
    outcome = program.run("demo", "--out", "result", "--json", cwd=cwd)
    tally.check("demo", outcome.status != 0 and f"{outcome}")
    if outcome.status != 0:
        return
    tally.check("demo's methods", [s["name"] for s in outcome.json()["structures"] if set(s["volume_ml"]) ^ METHODS])
    files = tree(cwd / "result")
    tally.check("demo's files", [kind for kind in (".mha", ".json", ".png") if not any(n.endswith(kind) for n in files)])
    pictures = [content for name, content in files.items() if name.endswith(".png")]
    tally.check("demo's picture", not all(p.startswith(b"\x89PNG") and len(p) > 5000 for p in pictures) and "is no PNG")
    tally.check("demo writes nowhere else", sorted(path.name for path in cwd.iterdir()) != ["result"] and "it does")


def interrupted(program, folder, tally):
    out = folder / "interrupted"
    out.mkdir()
    (out / "s.mha").write_text("old")
    # 0.4 GB, were it let alone.
    outcome = program.run(*SIMULATE, "--frames", 3000, "--out", out / "s.mha",
                          interrupt_after=lambda: len(list(out.iterdir())) > 1)
    tally.check("Ctrl-C: status", outcome.status in (0, 2) and f"{outcome}")
    tally.check("Ctrl-C: no output", outcome.out)
    tally.check("Ctrl-C: nothing left", tree(out) != {"s.mha": b"old"} and f"{sorted(tree(out))}")


def closed_output(program, folder, tally):
    """Results that cannot be shown are an error, too."""
    scan = folder / "output.mha"
    program.must_run(*SIMULATE, "--frames", 2, "--out", scan)
    if os.path.exists("/dev/full"):
        with open("/dev/full", "wb") as full:
            child = subprocess.run([program.path, "info", scan], stdout=full, stderr=subprocess.PIPE, check=False)
        tally.check("standard output to a full disk", child.returncode != 1 and f"status {child.returncode}")


def names_with_spaces(program, folder, tally):
    odd = folder / "Jörg's scan (1) 100% ☃"
    odd.mkdir()
    scan = odd / "-a b.mha"
    outcome = program.run(*SIMULATE, "--frames", 3, "--out", scan)
    tally.check("a name with spaces and accents", outcome.status != 0 and f"{outcome}")
    tally.check("and reading it", program.run("info", scan).status != 0 and "refused")
    complaint = complaint_about_error(program.run("info", odd / "none.mha"))
    tally.check("and complaining about it", complaint)


def body(program, folder, tally, _root):
    for part in (help_and_version, wrong_command_lines, scan_to_volume, seeds, round_trips, demo, interrupted,
                 closed_output, names_with_spaces):
        part(program, folder, tally)


if __name__ == "__main__":
    run_script(__doc__, body)
