"""Recordings of trackers and of a floor in the image, made without the program under test: their truth is known."""

import math
import random

TIP = (12.0, -7.0, 160.0)
LANDMARKS = {"nose": (0.0, 0.0, 0.0), "left ear": (-70.0, 20.0, 90.0), "right ear": (72.0, 22.0, 88.0),
             "chin": (3.0, 85.0, 8.0), "brow": (-8.0, -55.0, 12.0)}


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def turned(rotation, point):
    return [sum(row[k] * point[k] for k in range(3)) for row in rotation]


def rotation(x, y, z):
    """By angles in radians about x, then y, then z."""
    cx, sx, cy, sy, cz, sz = (f(angle) for angle in (x, y, z) for f in (math.cos, math.sin))
    return product([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]],
                   product([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]], [[1, 0, 0], [0, cx, -sx], [0, sx, cx]]))


def pose_text(turn, place):
    rows = [*turn[0], place[0], *turn[1], place[1], *turn[2], place[2], 0, 0, 0, 1]
    return " ".join(f"{value:.9g}" for value in rows)


def recording(tool, times, poses, images=None, size=(0, 0)):
    """The bytes of a `.mha`: poses are texts, None where lost; images one bytes object a frame."""
    lines = ["ObjectType = Image", "NDims = 3", f"DimSize = {size[0]} {size[1]} {len(times)}",
             "ElementType = MET_UCHAR", "UltrasoundImageOrientation = MFA"]
    for i, time in enumerate(times):
        lines.append(f"Seq_Frame{i:04d}_Timestamp = {time:.6f}")
        if poses:
            lost = poses[i] is None
            lines.append(f"Seq_Frame{i:04d}_{tool}ToTrackerTransform = {pose_text(rotation(0, 0, 0), (0, 0, 0)) if lost else poses[i]}")
            lines.append(f"Seq_Frame{i:04d}_{tool}ToTrackerTransformStatus = {'INVALID' if lost else 'OK'}")
    lines.append("ElementDataFile = LOCAL\n")
    return "\n".join(lines).encode() + b"".join(images or [])


def pointer_pose(turn, tip_place, noise_mm, random_numbers):
    offset = turned(turn, TIP)
    return pose_text(turn, [tip_place[k] - offset[k] + random_numbers.gauss(0, noise_mm) for k in range(3)])


def pivoting(count=300, tilt=(0.5, 0.4), noise_mm=0.2):
    """A pointer named Stylus, its tip resting in one point, tilted to all sides."""
    numbers = random.Random(3)
    times = [50 + 0.05 * i for i in range(count)]
    poses = [pointer_pose(rotation(tilt[0] * math.sin(0.11 * i), tilt[1] * math.cos(0.07 * i), 0.3),
                          (200.0, -150.0, 700.0), noise_mm, numbers) for i in range(count)]
    return recording("Stylus", times, poses)


IN_THE_AIR = {"in the air": (20.0, -90.0, 140.0)}  # no landmark


def moved_landmarks(names):
    """Where the landmarks, or that place, are in the tracker's coordinates."""
    turn, shift = rotation(0.4, -0.3, 1.1), (120.0, 40.0, 650.0)
    return [[value + offset for value, offset in zip(turned(turn, (LANDMARKS | IN_THE_AIR)[name]), shift)] for name in names]


def pointing(names, rest_s=1.2, move_s=0.8, noise_mm=0.2):
    """A pointer that rests on the landmarks in this order."""
    numbers = random.Random(4)
    places = moved_landmarks(names)
    times, poses = [], []
    leg_s = rest_s + move_s
    for i in range(int((leg_s * len(places) - move_s) / 0.04)):
        time = 0.04 * i
        leg = int(time / leg_s)
        part = max(0.0, (time - leg * leg_s - rest_s) / move_s)
        part *= part * (3 - 2 * part)
        following = places[min(leg + 1, len(places) - 1)]
        tip = [a + part * (b - a) for a, b in zip(places[leg], following)]
        times.append(10 + time)
        poses.append(pointer_pose(rotation(0.2 * math.sin(time), 0.1, 0), tip, noise_mm, numbers))
    return recording("Stylus", times, poses)


def hand(time):
    """Up and down in mm, never quite the same again."""
    return 7 * math.sin(1.7 * time) + 6 * math.sin(3.1 * time + 1) + 4 * math.sin(5.3 * time + 2)


def speckled_rows():
    """For every grey value a long row of speckle of that mean (Rayleigh's distribution), averaged over four looks."""
    numbers = random.Random(6)
    factors = [sum(math.sqrt(-math.log(1 - numbers.random())) for _ in range(4)) / (2 * math.sqrt(math.pi))
               for _ in range(2000)]
    return [bytes(min(255, int(value * factor)) for factor in factors) for value in range(256)]


def floor_image(depth, width, height, rows, numbers):
    """A bright floor whose edge is soft, so that it can lie between pixels."""
    image = []
    for y in range(height):
        below = y - depth
        value = 20 + 140 / (1 + math.exp(-1.5 * max(-40, min(40, below)))) * math.exp(-max(0, below) / 12)
        row = rows[int(value)]
        start = numbers.randrange(len(row) - width)
        image.append(row[start:start + width])
    return b"".join(image)


def probe_poses(times, latency_s):
    """A probe over a floor; what was at t is stamped t + latency."""
    numbers = random.Random(5)
    turn = rotation(0.2, 0.5, -0.4)
    return [pose_text(turn, [300 + 0.6 * hand(t - latency_s) + numbers.gauss(0, 0.1), 20 + numbers.gauss(0, 0.1),
                             500 + 0.8 * hand(t - latency_s) + numbers.gauss(0, 0.1)]) for t in times]


def over_floor(latency_s, seconds=7.0, motion=hand):
    """Three recordings: images alone, poses alone (at another rate), and both together."""
    size = (96, 160)
    image_times = [100 + 0.04 * i for i in range(int(seconds / 0.04))]
    tracker_times = [100 + 0.017 * i for i in range(int(seconds / 0.017))]
    rows, numbers = speckled_rows(), random.Random(7)
    images = [floor_image(80 - 2.5 * motion(t), *size, rows, numbers) for t in image_times]
    return (recording("Probe", image_times, None, images, size),
            recording("Probe", tracker_times, probe_poses(tracker_times, latency_s)),
            recording("Probe", image_times, probe_poses(image_times, latency_s), images, size))


# Where the image lies on the probe: the first pixel, image axes as columns, mm per pixel.
IMAGE_PLACE, IMAGE_TURN, PIXEL_MM = (10.0, -30.0, 5.0), rotation(0.3, -0.5, 1.2), (0.4, 0.35)


def spot_image(x, y, size):
    """Black, with a soft bright spot."""
    image = bytearray(size[0] * size[1])
    for row in range(max(0, int(y) - 7), min(size[1], int(y) + 8)):
        for column in range(max(0, int(x) - 7), min(size[0], int(x) + 8)):
            image[row * size[0] + column] = int(220 * math.exp(-((row - y) ** 2 + (column - x) ** 2) / 8))
    return bytes(image)


def over_point(count=60, moving=True, lost=(), scale=1.0, visible=True):
    """A probe that sees a bead, which rests at (100, -50, 600), in all parts of its image and from many sides."""
    size, bead = (128, 128), (100.0, -50.0, 600.0)
    times, poses, images = [], [], []
    for i in range(count):
        k = i if moving else 0
        pixel = (64 + 42 * math.sin(0.61 * k), 64 + 42 * math.cos(0.47 * k + 1))
        turn = rotation(0.5 * math.sin(0.9 * k), 0.5 * math.sin(0.7 * k + 2), 0.8 * math.sin(0.53 * k + 1))
        in_image = (pixel[0] * PIXEL_MM[0], pixel[1] * PIXEL_MM[1], 0.0)
        in_probe = [a + b for a, b in zip(IMAGE_PLACE, turned(IMAGE_TURN, in_image))]
        place = [a - b for a, b in zip(bead, turned(turn, in_probe))]
        times.append(20 + 0.1 * i)
        poses.append(None if i in lost else pose_text(turn, [scale * value for value in place]))
        images.append(spot_image(*pixel, size) if visible else bytes(size[0] * size[1]))
    return recording("Probe", times, poses, images, size)


def wire_phantom():
    """An N-wire phantom as Fathom's JSON."""
    def n(z, front, back):
        ends = [((0, 0, z), (0, 40, z)), ((front, 0, z), (back, 40, z)), ((30, 0, z), (30, 40, z))]
        return {"wires": [{"name": f"{z}{k}", "front": a, "back": b} for k, (a, b) in enumerate(ends)]}
    return {"fathom_phantom": 1, "name": "three", "patterns": [n(20, 27, 3), n(10, 3, 27), n(0, 24, 6)]}
