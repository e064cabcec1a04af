#!/usr/bin/env python3
"""Figures on real recordings (the project's shared data, where it is there), read here without the program under test."""

import json
import re

from program import complaint_about_error, run_script

PIXEL_TYPES = {"MET_UCHAR": "uint8", "int16": "int16"}
DRAWN_PRISM_ML = 16.863
PRISM_ML = 17.06  # what planimetry must make of the prism with PLUS's calibration; the drawing says 16.86


def seen_in(path):
    """What `fathom info` should say, from the header's text."""
    content = path.read_bytes()
    if content.startswith(b"NRRD"):
        header = content[: content.index(b"\n\n")].decode()
        fields = dict(re.findall(r"^([^:#\n]+):=?[ ]*(.*?)\s*$", header, re.MULTILINE))
        sizes = [int(n) for n in fields["sizes"].split()]
        pixel_type = PIXEL_TYPES[fields["type"]]
    else:
        header = content[: content.index(b"ElementDataFile")].decode()
        fields = dict(re.findall(r"^(\S+) = (.*?)\s*$", header, re.MULTILINE))
        sizes = [int(n) for n in fields["DimSize"].split()]
        pixel_type = PIXEL_TYPES[fields["ElementType"]]
    width, height, frames = (sizes + [1])[:3]
    transforms = {match.group(1) for key in fields if (match := re.fullmatch(r"Seq_Frame\d+_(\w+)Transform", key))}
    if "ProbeToTracker" in transforms:
        needed = transforms & {"ProbeToTracker", "ReferenceToTracker"}
    else:
        needed = {fields.get("DefaultFrameTransformName", "none").removesuffix("Transform")}

    def is_valid(frame):
        prefix = f"Seq_Frame{frame:04}_"
        return (fields.get(prefix + "ImageStatus", "OK") == "OK"
                and all(prefix + name + "Transform" in fields for name in needed)
                and all(fields.get(prefix + name + "TransformStatus", "OK") == "OK" for name in needed))

    times = [float(fields[key]) for key in fields if re.fullmatch(r"Seq_Frame\d+_Timestamp", key)]
    return {
        "frames": frames,
        "valid_frames": sum(map(is_valid, range(frames))),
        "width": width,
        "height": height,
        "pixel_type": pixel_type,
        "duration_s": max(times) - min(times) if len(times) > 1 else None,
        "frame_rate_hz": (len(times) - 1) / (max(times) - min(times)) if len(times) > 1 else None,
        "transforms": transforms,
    }


def differs(found, expected):
    if isinstance(expected, float) and found is not None:
        return abs(found - expected) > 1e-6 * max(1.0, abs(expected))
    if isinstance(expected, set):
        return len(found) != len(expected) or set(found) != expected
    return found != expected


def spatial(program, folder, tally, data):
    """From images to a calibration, on the first sweep alone; judged on the second."""
    phantom = data / "PlusDeviceSet_fCal_Sim_SpatialCalibration_2.0.xml"
    sweep = data / "fCal_Test_Calibration_3NWires_fCal2.0.igs.mha"
    second = data / "fCal_Test_Validation_3NWires_fCal2.0.igs.mha"
    command = ["calibrate", "spatial", sweep, "--validate", second, "--phantom"]
    out = folder / "wires.json"
    found = program.must_run(*command, phantom, "--out", out, "--picture", folder / "wires.png", "--json").json()
    print({key: found[key] for key in ("validation_mean_mm", "validation_wire_mean_mm", "validation_wire_rms_mm")})
    # PLUS's own calibration: 0.540 by the points that it finds itself, 0.408 and 0.476.
    for key, most in (("validation_mean_mm", 0.555), ("validation_wire_mean_mm", 0.36), ("validation_wire_rms_mm", 0.41)):
        tally.check(f"calibrate spatial: {key}", not found[key] <= most and f"{found[key]}")
    tally.check("calibrate spatial: nearly all frames", found["frames_used"] < 180 and found)
    prism = program.must_run("measure", sweep, "--calibration", out, "--contours", data / "fCal2_wire_prism.contours.json",
                             "--json").json()["structures"][0]["volume_ml"]["cubic_planimetry"]
    print(f"prism by our calibration: {prism:.3f} ml")
    tally.check("the prism by our calibration", abs(prism / DRAWN_PRISM_ML - 1) > 0.01 and f"{prism} ml")

    text = phantom.read_text()
    mirrored = folder / "mirrored.xml"
    # The middle wires the other way round: N becomes the N of a mirror.
    mirrored.write_text(re.sub(r'(Name="[852]:\w*" EndPointFront="[0-9.]+ )([0-9.]+)( [0-9.]+" EndPointBack="[0-9.]+ )([0-9.]+)',
                               r"\g<1>\g<4>\g<3>\g<2>", text))
    outcome = program.run("calibrate", "spatial", sweep, "--phantom", mirrored, "--out", folder / "none.json", cwd=folder)
    tally.check("calibrate spatial refuses a mirrored phantom",
                complaint_about_error(outcome) or ("mirror image" not in outcome.err and outcome.err))


def body(program, folder, tally, root):
    data = root.parent / "shared" / "data" / "plus"
    if not data.is_dir():
        tally.skip("real recordings", "the recordings of shared/data are not beside this checkout")
        return
    for path in sorted([*data.glob("*.mha"), *data.glob("*.nrrd")]):
        info = program.must_run("info", path, "--json").json()
        for key, expected in seen_in(path).items():
            tally.check(f"{path.name}: {key}", differs(info.get(key), expected) and f"{info.get(key)}, not {expected}")

    outcome = program.must_run(
        "measure", data / "fCal_Test_Calibration_3NWires_fCal2.0.igs.mha", "--calibration",
        data / "FreehandCalibration3NWires_fCal2.0.results.xml", "--contours",
        data / "fCal2_wire_prism.contours.json", "--json")
    prism = outcome.json()["structures"][0]
    sections = json.loads((data / "fCal2_wire_prism.contours.json").read_text())["structures"][0]["contours"]
    tally.check("the prism's sections", prism["sections"] != len(sections) and prism["sections"])
    for method in ("linear_planimetry", "cubic_planimetry", "cubic_planimetry_3d"):
        volume = prism["volume_ml"][method]
        tally.check(f"the prism by {method}", abs(volume - PRISM_ML) > 0.02 and f"{volume} ml")
        print(f"prism, {method}: {volume:.4f} ml")

    # Scans of wires, a pointer lying beside them: neither tells a tip or a latency.
    for kind, recording, words in (
            ("pivot", [data / "fCal_Test_Calibration_3NWires_fCal2.0.igs.mha"], "hardly turned"),
            ("pivot", [data / "NwirePhantomFreehand.igs.mha"], "0 valid poses"),
            ("temporal", ["--image", data / "fCal_Test_Validation_3NWires_fCal2.0.igs.mha"], "shows a wall"),
            ("temporal", ["--image", data / "SpinePhantomFreehand.igs.mha"], "shows a wall")):
        outcome = program.run("calibrate", kind, *recording, cwd=folder)
        tally.check(f"calibrate {kind} refuses {recording[-1].name}",
                    complaint_about_error(outcome) or (words not in outcome.err and outcome.err))

    spatial(program, folder, tally, data)

    # What was recorded elsewhere survives the way through every format.
    original = data / "SpinePhantomFreehand.igs.mha"
    expected = seen_in(original)
    for name in ("spine.mha", "spine.mhd", "spine.nrrd"):
        program.must_run("convert", original, folder / name)
        info = program.must_run("info", folder / name, "--json").json()
        wrong = [key for key in expected if differs(info.get(key), expected[key])]
        tally.check(f"the spine sweep as {name}", wrong)


if __name__ == "__main__":
    run_script(__doc__, body)
