#!/usr/bin/env python3
"""Surfaces of equations and volumes: size, place and closedness of the meshes, and what is refused."""

import math
import struct

from program import complaint_about_error, run_script, tree

KEYS = ["vertices", "triangles", "volume_ml", "area_cm2", "closed", "radius_ratio_p95", "above_2", "seconds"]
BALL = 4 / 3 * math.pi  # mm^3 for a radius of 1 mm
UNIT_BOX = "-1.5,1.5,-1.5,1.5,-1.5,1.5"


def off(found, expected, tolerance):
    """A complaint if `found` is not `expected` within a relative tolerance."""
    if found is None or abs(found - expected) > tolerance * abs(expected):
        return f"{found} instead of {expected} (within {tolerance:g})"
    return None


def ply_vertices(content):
    """The positions in a binary PLY file that begins its vertices with x, y and z in double precision."""
    header, body = content.split(b"end_header\n", 1)
    lines = header.decode().splitlines()
    assert "format binary_little_endian 1.0" in lines, lines
    count, sizes, names, inside = 0, [], [], False
    for line in lines:
        words = line.split()
        if words[0] == "element":
            inside = words[1] == "vertex"
            count = int(words[2]) if inside else count
        elif words[0] == "property" and inside:
            sizes.append({"double": 8, "float": 4, "uchar": 1, "char": 1, "int": 4}[words[1]])
            names.append(words[2])
    assert names[:3] == ["x", "y", "z"] and sizes[:3] == [8, 8, 8], names
    return [struct.unpack_from("<3d", body, i * sum(sizes)) for i in range(count)]


def extent(path):
    """Middle and half size of a mesh along each axis."""
    vertices = ply_vertices(path.read_bytes())
    low, high = ([pick(v[axis] for v in vertices) for axis in range(3)] for pick in (min, max))
    return [(h + l) / 2 for l, h in zip(low, high)], [(h - l) / 2 for l, h in zip(low, high)]


def multiply(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def turn(axis, angle):
    c, s = math.cos(angle), math.sin(angle)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = [[float(row == column) for column in range(3)] for row in range(3)]
    matrix[i][i], matrix[i][j], matrix[j][i], matrix[j][j] = c, -s, s, c
    return matrix


UPRIGHT = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]


class Grid:
    """Where the voxels of a volume lie: column i of `axes` is the direction of index i."""

    def __init__(self, size, spacing, axes=None, origin=(0, 0, 0)):
        self.size, self.spacing, self.axes, self.origin = size, spacing, axes or UPRIGHT, origin

    def place(self, index):
        return [self.origin[r] + sum(self.axes[r][c] * self.spacing[c] * index[c] for c in range(3)) for r in range(3)]

    def middle(self):
        return self.place([(n - 1) / 2 for n in self.size])

    def volume(self, value_at):
        """A MetaImage with a value for every place."""
        values = [value_at(self.place((i, j, k))) for k in range(self.size[2]) for j in range(self.size[1])
                  for i in range(self.size[0])]

        def numbers(these):
            return " ".join(repr(float(number)) for number in these)

        directions = [self.axes[r][c] for c in range(3) for r in range(3)]  # a row of the file for each index
        header = ("ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
                  f"TransformMatrix = {numbers(directions)}\nOffset = {numbers(self.origin)}\n"
                  f"ElementSpacing = {numbers(self.spacing)}\nDimSize = {' '.join(map(str, self.size))}\n"
                  "ElementType = MET_FLOAT\nElementDataFile = LOCAL\n")
        return header.encode() + struct.pack(f"<{len(values)}f", *values)


def ball(centre, radius):
    """Above 0 inside of a ball."""
    return lambda place: radius - math.dist(place, centre)


def must_refuse(program, tally, folder, name, arguments, *parts):
    """One clear line that has these parts, and an old file that stays."""
    out = folder / "refused"
    out.mkdir(exist_ok=True)
    (out / "old.ply").write_text("old")
    outcome = program.run(*arguments, "--out", out / "old.ply")
    complaint = complaint_about_error(outcome)
    if not complaint and tree(out) != {"old.ply": b"old"}:
        complaint = f"changed: {sorted(tree(out))}"
    if not complaint and not all(part in outcome.err for part in parts):
        complaint = f"does not say {parts}: {outcome.err}"
    tally.check(f"refused: {name}", complaint)


def eqnsurf(program, out, equation, bounds=UNIT_BOX, spacing=0.1, *options):
    return program.must_run("eqnsurf", equation, "--bounds", bounds, "--spacing", spacing, "--out", out, *options,
                            "--json").json()


def isosurface(program, out, volume, value, *options):
    return program.must_run("isosurface", volume, "--value", value, "--out", out, *options, "--json").json()


def equations(program, folder, tally):
    out = folder / "ball.ply"
    for options in ([], ["--placement", "curvature"], ["--mesher", "mt"], ["--mesher", "mc"]):
        made = eqnsurf(program, out, "x^2+y^2+z^2-1", UNIT_BOX, 0.05, *options)
        name = " ".join(["a ball", *options])
        tally.check(f"{name}: keys", list(made)[:len(KEYS)] != KEYS and list(made))
        tally.check(f"{name}: volume", off(made["volume_ml"], BALL / 1000, 0.01))
        tally.check(f"{name}: area", off(made["area_cm2"], 4 * math.pi / 100, 0.01))
        tally.check(f"{name}: closed", made["closed"] is not True or made["vertices"] - made["triangles"] / 2 != 2)
        tally.check(f"{name}: vertices in the file", len(ply_vertices(out.read_bytes())) != made["vertices"])
        if "--mesher" not in options:
            tally.check(f"{name}: triangles", made["radius_ratio_p95"] > 2 or made["above_2"] > 0.01)

    counts, files = {}, {}
    for mesher in ("mc", "mt", "rmt"):
        counts[mesher] = eqnsurf(program, out, "x^2+y^2+z^2-1", UNIT_BOX, 0.1, "--mesher", mesher)["triangles"]
        files[mesher] = out.read_bytes()
    tally.check("three meshers, three meshes", not counts["rmt"] < counts["mc"] < counts["mt"] and f"{counts}")
    eqnsurf(program, out, "x^2+y^2+z^2-1", UNIT_BOX, 0.1)
    tally.check("the same mesh each time, and rmt where none is named", files["rmt"] != out.read_bytes() and "it differs")

    made = eqnsurf(program, out, "(x-20)^2/4 + (y+10)^2 + (z-1000)^2/9", "17,23,-12,-8,996,1004", 0.1, "--threshold", 1)
    tally.check("an ellipsoid: volume", off(made["volume_ml"], BALL * 6 / 1000, 0.01))
    middle, half = extent(out)
    tally.check("an ellipsoid: place", max(abs(a - b) for a, b in zip(middle, (20, -10, 1000))) > 0.02 and middle)
    tally.check("an ellipsoid: size", max(abs(a - b) for a, b in zip(half, (2, 1, 3))) > 0.02 and half)
    made = eqnsurf(program, out, "(sqrt(x^2 + y^2) - 1)^2 + z^2 - 0.09", UNIT_BOX, 0.03)
    tally.check("a torus: volume", off(made["volume_ml"], 2 * math.pi**2 * 0.09 / 1000, 0.01))
    tally.check("a torus: genus", made["vertices"] - made["triangles"] / 2 != 0 and f"{made}")
    shown = program.must_run("eqnsurf", "x^2+y^2+z^2-1", "--bounds", UNIT_BOX, "--spacing", 0.1, "--out", out).out
    tally.check("a table for people", [word for word in ("ml", "cm2", "closed", str(out)) if word not in shown])
    text = program.must_run("eqnsurf", "--help").out
    tally.check("help lists the functions", [word for word in ("atan2", "sqrt", "pi", "&&") if word not in text])
    leading = program.run("eqnsurf", "--bounds", UNIT_BOX, "--spacing", 0.1, "--out", out, "--", "-1+x^2+y^2+z^2")
    tally.check("an equation that begins with a minus sign", leading.status != 0 and f"{leading}")


def open_and_capped(program, folder, tally):
    out = folder / "half.ply"
    for mesher in ("rmt", "mt", "mc"):
        half = ("z", "-1,1,-2,2,-1.5,3", 0.1, "--mesher", mesher)
        made = eqnsurf(program, out, *half)
        tally.check(f"{mesher}: a plane is open", made["closed"] or made["volume_ml"] is not None)
        tally.check(f"{mesher}: and says so", not any("--cap" in text for text in made["warnings"]) and f"{made}")
        tally.check(f"{mesher}: area of a plane", off(made["area_cm2"], 0.08, 1e-5))
        made = eqnsurf(program, out, *half, "--cap")
        tally.check(f"{mesher}: capped", not made["closed"] or made["warnings"])
        tally.check(f"{mesher}: volume of the capped half", off(made["volume_ml"], 0.012, 0.003))
        tally.check(f"{mesher}: size of the capped half", off(extent(out)[1][1], 2, 1e-4))
        # A corner, so that caps meet in edges: an eighth of a ball.
        made = eqnsurf(program, out, "x^2+y^2+z^2-1", "0,2,0,2,0,2", 0.05, "--mesher", mesher, "--cap")
        tally.check(f"{mesher}: an eighth of a ball", off(made["volume_ml"], BALL / 8000, 0.005) or not made["closed"])


def refused_equations(program, folder, tally):
    def refuse(name, equation, *parts, bounds=UNIT_BOX, spacing=0.1, more=()):
        must_refuse(program, tally, folder, name, ["eqnsurf", equation, "--bounds", bounds, "--spacing", spacing, *more],
                    *parts)

    refuse("nothing", "", "empty")
    refuse("blanks", "   ", "empty")
    refuse("an unknown name", "x^2 + radius", "radius")
    refuse("an unknown function", "sinus(x)", "sinus")
    refuse("an assignment", "x = 3", "=")
    refuse("two expressions", "x, y", "comma")
    refuse("text", "\"x\"")
    refuse("no operator", "2x + 1", "2*x")
    refuse("an open bracket", "(x + 1", "bracket")
    refuse("many brackets", "(" * 4000 + "x" + ")" * 4000, "bracket")
    refuse("a long one", "x" + "+1" * 20000, "longer")
    refuse("a line break", "x\n+1")
    refuse("no number somewhere", "sqrt(x) - 0.5", "finite", "mm")
    refuse("infinite somewhere", "1/(x - x) + y", "finite")
    refuse("all outside", "x^2+y^2+z^2+1", "crosses 0", "between")
    refuse("all inside", "-1", "crosses 0", "between -1 and -1")
    refuse("missed by the threshold", "x", "crosses 100", more=("--threshold", 100))
    refuse("a spacing larger than the box", "x", "wider than the box", spacing=7)
    refuse("a spacing too fine", "x", "samples", "GB", spacing=1e-6)
    refuse("a spacing far too fine", "x", "samples", "GB", spacing=1e-300)
    refuse("an endless box", "x", bounds="-1e308,1e308,-1,1,-1,1")
    for path in ("mesh.xyz", "mesh", "no/such/folder/mesh.ply", "."):
        out = folder / "nowhere"
        out.mkdir(exist_ok=True)
        complaint = complaint_about_error(program.run("eqnsurf", "x", "--bounds", UNIT_BOX, "--spacing", 0.5, "--out",
                                                      out / path))
        tally.check(f"refused: --out {path}", complaint or list(out.iterdir()))


def wrong_command_lines(program, folder, tally):
    empty = folder / "empty"
    empty.mkdir()
    good = ["eqnsurf", "x", "--bounds", UNIT_BOX, "--spacing", "0.5", "--out", "m.ply"]

    def with_value(key, value):
        changed = list(good)
        changed[changed.index(key) + 1] = value
        return changed

    lines = [["eqnsurf"], good[:-2], good[2:], good[:2] + good[4:], good[:4] + good[6:]]
    lines += [with_value("--bounds", bounds) for bounds in (
        "", "1", "0,1,0,1,0", "0,1,0,1,0,1,2", "1,0,0,1,0,1", "0,1,1,1,0,1", "0,1,0,1,0,nan", "0,1,0,1,0,inf",
        "0,1,,1,0,1", "0 1 0 1 0 1", "a,b,c,d,e,f")]
    lines += [with_value("--spacing", spacing) for spacing in ("0", "-1", "nan", "inf", "fine")]
    lines += [good + more for more in (["--threshold", "nan"], ["--mesher", "cubes"], ["--placement", "best"],
                                       ["--mesher"], ["--turbo"])]
    volume = ["isosurface", "v.mha", "--value", "1", "--out", "m.ply"]
    lines += [["isosurface"], volume[:2] + volume[4:], volume[:4], volume[:1] + volume[2:]]
    lines += [volume + more for more in (["--inside", "left"], ["--open-mm", "-1"], ["--close-mm", "nan"],
                                         ["--spacing-mm", "0"], ["--mesher", "rmtt"])]
    for line in lines:
        outcome = program.run(*line, cwd=empty)
        wrong = outcome.status != 2 or outcome.out or not outcome.err
        tally.check(f"fathom {' '.join(line)}", wrong and f"{outcome}")
        tally.check(f"fathom {' '.join(line)} writes nothing", sorted(tree(empty)))


def volumes(program, folder, tally):
    out, path = folder / "volume.ply", folder / "volume.mha"
    turned = multiply(turn(2, 0.7), multiply(turn(0, -0.4), turn(1, 2.1)))
    mirrored = multiply(turned, [[1, 0, 0], [0, 1, 0], [0, 0, -1]])
    for name, axes in (("upright", None), ("turned", turned), ("mirrored", mirrored)):
        grid = Grid((34, 26, 20), (0.9, 1.2, 1.6), axes, (310, -45.5, 20))
        centre, radius = grid.middle(), 12.0
        path.write_bytes(grid.volume(ball(centre, radius)))
        for mesher in ("rmt", "mt", "mc"):
            made = isosurface(program, out, path, 0, "--mesher", mesher)
            tally.check(f"{name}, {mesher}: keys", list(made)[:len(KEYS)] != KEYS and list(made))
            tally.check(f"{name}, {mesher}: closed", made["closed"] is not True and f"{made}")
            tally.check(f"{name}, {mesher}: volume", off(made["volume_ml"], BALL * radius**3 / 1000, 0.015))
            middle, half = extent(out)
            tally.check(f"{name}, {mesher}: place", math.dist(middle, centre) > 0.1 and f"{middle}, not {centre}")
            tally.check(f"{name}, {mesher}: size", max(abs(h - radius) for h in half) > 0.15 and f"{half}")
        made = isosurface(program, out, path, 2)
        tally.check(f"{name}: another value", off(made["volume_ml"], BALL * (radius - 2) ** 3 / 1000, 0.015))
        made = isosurface(program, out, path, 0, "--spacing-mm", 2.5)
        tally.check(f"{name}: a coarse lattice", off(made["volume_ml"], BALL * radius**3 / 1000, 0.06))

        # Outside of the ball: open at the border, unless capped.
        made = isosurface(program, out, path, 0, "--inside", "below", "--cap")
        box = math.prod((n - 1) * s for n, s in zip(grid.size, grid.spacing))
        tally.check(f"{name}: the other side", off(made["volume_ml"], (box - BALL * radius**3) / 1000, 0.01))
        tally.check(f"{name}: the other side is closed", not made["closed"] or made["warnings"])

    path.write_bytes(grid.volume(ball(grid.place((16, 12, 10)), 9)))
    whole = isosurface(program, out, path, 0)["volume_ml"]
    path.write_bytes(grid.volume(ball(grid.place((16, 12, 0)), 9)))
    made = isosurface(program, out, path, 0)
    tally.check("a ball cut by the border is open", made["closed"] or made["volume_ml"] is not None)
    tally.check("and says how to close it", not any("--cap" in text for text in made["warnings"]) and f"{made}")
    made = isosurface(program, out, path, 0, "--cap")
    tally.check("half a ball, capped", off(made["volume_ml"], whole / 2, 0.01) or not made["closed"])
    shown = program.must_run("isosurface", path, "--value", 0, "--out", out).out
    tally.check("the warning for people", "warning: " not in shown and shown)


def parts(made):
    """The number of closed surfaces without handles in a mesh: each has V - E + F = 2, and 2 E = 3 F."""
    return (made["vertices"] - made["triangles"] / 2) / 2 if made["closed"] else None


def morphology(program, folder, tally):
    """A ball with a speck beside it and a hole within, and the same in the negative."""
    out, path = folder / "speck.ply", folder / "speck.mha"
    grid = Grid((44, 40, 24), (0.5, 0.5, 1.0))
    centre, radius = grid.middle(), 7.0
    speck, hole = (2.5, 2.5, 11), (centre[0] + 3, centre[1], 12)

    def bright(place):
        if math.dist(place, speck) < 1.1:
            return 1.0
        return -1.0 if math.dist(place, hole) < 1.1 else max(-1.0, min(1.0, radius - math.dist(place, centre)))

    opened, closed = ("--open-mm", 1.5), ("--close-mm", 1.5)
    for name, sign, side in (("bright", 1, ()), ("dark", -1, ("--inside", "below"))):
        path.write_bytes(grid.volume(lambda place, sign=sign: sign * bright(place)))
        for options, expected in (((), 3), (opened, 2), (closed, 2), ((*opened, *closed), 1)):
            made = isosurface(program, out, path, 0, *side, *options)
            tally.check(f"{name}: surfaces with {options}", parts(made) != expected and f"{made}")
        tally.check(f"{name}: the ball stays", off(made["volume_ml"], BALL * radius**3 / 1000, 0.03))


def refused_volumes(program, folder, tally):
    grid = Grid((8, 7, 6), (1, 1, 1))
    good = ball(grid.middle(), 2)

    def refuse(name, content, value, *parts, more=()):
        (folder / "bad.mha").write_bytes(content)
        must_refuse(program, tally, folder, name, ["isosurface", folder / "bad.mha", "--value", value, *more],
                    "bad.mha", *parts)

    whole = grid.volume(good)
    refuse("a value below all", whole, -100, "crosses -100", "between")
    refuse("a value above all", whole, 100, "crosses 100")
    refuse("a value below all, the other side", whole, -100, "crosses", more=("--inside", "below"))
    for wrong in (math.nan, math.inf, -math.inf):
        refuse(f"a voxel that is {wrong}",
               grid.volume(lambda place, wrong=wrong: wrong if place == [3, 4, 2] else good(place)), 0, "(3, 4, 2)")
    refuse("one slice", Grid((8, 7, 1), (1, 1, 1)).volume(good), 0, "at least two")
    refuse("a spacing too fine", whole, 0, "GB", more=("--spacing-mm", "1e-7"))
    refuse("a spacing larger than the volume", whole, 0, "wider than", more=("--spacing-mm", 50))
    refuse("cut short", whole[:-1], 0)
    refuse("no volume at all", b"ply\n", 0)
    must_refuse(program, tally, folder, "no file", ["isosurface", folder / "none.mha", "--value", 0], "none.mha")


def interrupted(program, folder, tally):
    out = folder / "interrupted"
    out.mkdir()
    (out / "m.ply").write_text("old")
    # A minute or so, were it let alone.
    outcome = program.run("eqnsurf", "sin(9*x)+cos(9*y)+sin(9*z)", "--bounds", UNIT_BOX, "--spacing", 0.004, "--out",
                          out / "m.ply", interrupt_after=lambda: len(list(out.iterdir())) > 1)
    tally.check("Ctrl-C", complaint_about_error(outcome))
    tally.check("Ctrl-C: soon", outcome.seconds > (100 if program.sanitized else 20) and f"{outcome.seconds} s")
    tally.check("Ctrl-C: nothing left", tree(out) != {"m.ply": b"old"} and f"{sorted(tree(out))}")


def formats(program, folder, tally):
    out = folder / "formats"
    out.mkdir()
    for extension, start in ((".ply", b"ply\n"), (".stl", b""), (".obj", b""), (".off", b"NOFF\n"), (".wrl", b"#VRML V2.0")):
        eqnsurf(program, out / f"m{extension}", "x^2+y^2+z^2-1", UNIT_BOX, 0.3)
        tally.check(f"a mesh as {extension}", not (out / f"m{extension}").read_bytes().startswith(start))
    tally.check("only these files", len(tree(out)) != 5 and sorted(tree(out)))


def body(program, folder, tally, _root):
    for part in (wrong_command_lines, equations, open_and_capped, refused_equations, volumes, morphology,
                 refused_volumes, interrupted, formats):
        part(program, folder, tally)


if __name__ == "__main__":
    run_script(__doc__, body)
