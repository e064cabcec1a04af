"""Damaged calibrations, contours and exams, made from good ones. Each case: a name and the content of the file."""

import json

DEEP = 200_000
HUGE_BYTES = 40_000_000


def without(document, key):
    return {k: v for k, v in document.items() if k != key}


def broken_json(text):
    """What may befall any JSON file."""
    yield "empty", b""
    yield "white space", b" \n"
    yield "cut short", text[: len(text) // 2]
    yield "one bracket short", text.rstrip()[:-1]
    yield "followed by more", text + b" {}"
    yield "rubbish", bytes((i * i * 7 + i // 3) & 255 for i in range(5000))
    yield "an array", b"[]"
    yield "a number", b"1"
    yield "null", b"null"
    yield "text that is not UTF-8", text.replace(b'"', b'"\xff', 1)
    yield "nested deep", b"[" * DEEP + b"]" * DEEP
    yield "nested deep objects", b'{"a":' * DEEP + b"1" + b"}" * DEEP
    yield "nested deep and cut", b"[" * HUGE_BYTES
    yield "millions of empty objects", b"[" + b"{}," * (HUGE_BYTES // 3) + b"{}]"
    yield "zeros", bytes(100_000)


def calibrations(good_text):
    """Calibration files as Fathom writes them."""
    good = json.loads(good_text)
    matrix = good["image_to_probe"]

    def changed(**values):
        return json.dumps({**good, **values}).encode()

    def with_matrix(*changes):
        numbers = list(matrix)
        for index, value in changes:
            numbers[index] = value
        return changed(image_to_probe=numbers)

    yield from broken_json(good_text)
    yield "another kind of file", json.dumps({"fathom_contours": 1, "structures": []}).encode()
    yield "of a version to come", changed(fathom_calibration=2)
    yield "a version that is a text", changed(fathom_calibration="1")
    yield "no version", json.dumps(without(good, "fathom_calibration")).encode()
    yield "no matrix", json.dumps(without(good, "image_to_probe")).encode()
    yield "a matrix of 15 numbers", changed(image_to_probe=matrix[:15])
    yield "a matrix of 17 numbers", changed(image_to_probe=matrix + [1])
    yield "a matrix of rows", changed(image_to_probe=[matrix[i: i + 4] for i in (0, 4, 8, 12)])
    yield "a matrix that is a text", changed(image_to_probe=" ".join(map(str, matrix)))
    yield "a matrix with NaN", with_matrix((0, float("nan")))
    yield "a matrix with null", with_matrix((0, None))
    yield "a matrix with a text", with_matrix((5, "0.1"))
    yield "a matrix beyond all numbers", changed(image_to_probe=["HUGE"] + matrix[1:]).replace(b'"HUGE"', b"1e999")
    yield "a singular matrix", with_matrix(*((i, 0) for i in (0, 4, 8)))
    yield "a matrix whose columns agree", with_matrix(*((i + 1, matrix[i]) for i in (0, 4, 8)))
    yield "a matrix of zeros", changed(image_to_probe=[0] * 16)
    yield "a matrix whose last row is not 0 0 0 1", with_matrix((15, 2))
    yield "pixels of a kilometre", with_matrix(*((i, 1e7 * matrix[i]) for i in (0, 1, 4, 5, 8, 9)))
    yield "pixels of an atom", with_matrix(*((i, 1e-7 * matrix[i]) for i in (0, 1, 4, 5, 8, 9)))
    yield "of another image size", changed(width=820, height=616)
    yield "of an impossible image size", changed(width=-330, height=420)
    yield "an image size that is a text", changed(width="330", height="420")
    yield "a latency that is a text", changed(latency_s="0.1")
    yield "an infinite latency", changed(latency_s="HUGE").replace(b'"HUGE"', b"1e999")
    yield "a probe frame that is a number", changed(probe_frame=7)
    yield "a probe frame that is not recorded", changed(probe_frame="Stylus")
    yield "a reference frame that is not recorded", changed(reference_frame="Table")
    yield "a covariance that fits no parameters", changed(parameters=["tx_mm"], covariance=[[1, 0], [0, 1]])


GOOD_XML = """<?xml version="1.0"?>
<PlusConfiguration version="2.1">
  <CoordinateDefinitions>
    <Transform From="Image" To="Probe" Matrix="0.12 0 0 -20 0 0.12 0 5 0 0 0.12 3 0 0 0 1" />
    <Transform From="Reference" To="Tracker" Matrix="1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1" />
  </CoordinateDefinitions>
</PlusConfiguration>
"""

ENTITY_BOMB = """<?xml version="1.0"?>
<!DOCTYPE b [<!ENTITY a0 "lol">%s]>
<PlusConfiguration><CoordinateDefinitions><Transform From="Image" To="Probe" Matrix="&a9;"/></CoordinateDefinitions>
</PlusConfiguration>
""" % "".join(f'<!ENTITY a{n} "{f"&a{n - 1};" * 10}">' for n in range(1, 10))


def plus_calibrations():
    """Configuration files of PLUS."""

    def matrix(text):
        return GOOD_XML.replace("0.12 0 0 -20 0 0.12 0 5 0 0 0.12 3 0 0 0 1", text).encode()

    yield "cut short", GOOD_XML[: len(GOOD_XML) // 2].encode()
    yield "only a declaration", b'<?xml version="1.0"?>'
    yield "an empty element", b"<PlusConfiguration/>"
    yield "another document", b"<html><body>404 not found</body></html>"
    yield "tags that do not match", GOOD_XML.replace("</PlusConfiguration>", "</Plus>").encode()
    yield "no transform of the image", GOOD_XML.replace('From="Image"', 'From="Phantom"').encode()
    yield "no matrix", GOOD_XML.replace("Matrix=", "Comment=").encode()
    yield "a matrix of 15 numbers", matrix("0.12 0 0 -20 0 0.12 0 5 0 0 0.12 3 0 0 0")
    yield "a matrix of 17 numbers", matrix("0.12 0 0 -20 0 0.12 0 5 0 0 0.12 3 0 0 0 1 1")
    yield "a matrix with NaN", matrix("nan 0 0 -20 0 0.12 0 5 0 0 0.12 3 0 0 0 1")
    yield "a matrix with a word", matrix("0.12 0 0 left 0 0.12 0 5 0 0 0.12 3 0 0 0 1")
    yield "a singular matrix", matrix("0 0 0 -20 0 0.12 0 5 0 0 0.12 3 0 0 0 1")
    yield "an empty matrix", matrix("")
    yield "a transform given twice, differently", GOOD_XML.replace(
        "</CoordinateDefinitions>",
        '<Transform From="Image" To="Probe" Matrix="0.5 0 0 0 0 0.5 0 0 0 0 0.5 0 0 0 0 1"/></CoordinateDefinitions>',
    ).encode()
    yield "an entity bomb", ENTITY_BOMB.encode()
    yield "nested deep", b"<a>" * DEEP + b"</a>" * DEEP
    yield "nested deep and cut", b"<a>" * (HUGE_BYTES // 3)
    yield "millions of elements", b"<a>" + b"<a/>" * (HUGE_BYTES // 4) + b"</a>"


def contours(good_text, frames):
    """Contours on a recording of this many frames."""
    good = json.loads(good_text)
    square = [[100, 100], [200, 100], [200, 200], [100, 200]]

    def structures(*all_structures):
        return json.dumps({"fathom_contours": 1, "structures": list(all_structures)}).encode()

    def drawn(*all_contours, **fields):
        return structures({"name": "organ", "contours": list(all_contours), **fields})

    def contour(**fields):
        return drawn({"frame": 1, "closed": True, "points": square}, {"frame": 2, "closed": True, "points": square,
                                                                      **fields})

    yield from broken_json(good_text)
    yield "another kind of file", b'{"fathom_calibration": 1}'
    yield "of a version to come", json.dumps({**good, "fathom_contours": 2}).encode()
    yield "no structures", json.dumps(without(good, "structures")).encode()
    yield "structures that are an object", json.dumps({**good, "structures": {}}).encode()
    yield "a structure that is a number", structures(7)
    yield "a structure without a name", structures({"contours": []})
    yield "a name that is a number", structures({"name": 7, "contours": []})
    yield "an empty name", structures({"name": "", "contours": []})
    yield "a name used twice", structures({"name": "a", "contours": []}, {"name": "a", "contours": []})
    yield "a colour that is none", drawn(color="reddish")
    yield "contours that are a text", structures({"name": "a", "contours": "none"})
    yield "a contour that is a number", drawn(7)
    for text in (frames, -1, 1_000_000_000, 2_147_483_648, -9_223_372_036_854_775_808, 1e300, 1.5, "2", None, [2]):
        yield f"frame {text!r}", contour(frame=text)
    yield "no frame", drawn({"closed": True, "points": square})
    yield "no points", drawn({"frame": 2, "closed": True})
    yield "an empty contour", contour(points=[])
    yield "a contour of one point", contour(points=square[:1])
    yield "a contour of two points", contour(points=square[:2])
    yield "points that are a text", contour(points="100,100")
    yield "a point that is a number", contour(points=square + [5])
    yield "a point of one number", contour(points=square + [[5]])
    yield "a point of three numbers", contour(points=square + [[5, 5, 5]])
    yield "a point with a text", contour(points=square + [["5", 5]])
    yield "a point with null", contour(points=square + [[None, 5]])
    yield "a point that is NaN", contour(points=square + [[float("nan"), 5]])
    yield "a point beyond all numbers", contour(points=square + [["HUGE", 5]]).replace(b'"HUGE"', b"1e999")
    yield "a point beyond all images", contour(points=square + [[1e300, 5]])
    yield "closed: 'yes'", contour(closed="yes")
    yield "a confidence of 7", contour(confidence=7)
    yield "an open contour", contour(closed=False)
    yield "a bow tie", contour(points=[square[0], square[2], square[1], square[3]])
    yield "a contour that crosses another", drawn(
        {"frame": 1, "closed": True, "points": square},
        {"frame": 1, "closed": True, "points": [[x + 50, y + 50] for x, y in square]})
    yield "a frame both outlined and without it", drawn({"frame": 2, "closed": True, "points": square},
                                                        {"frame": 2, "absent": True})
    yield "a point instead of a contour, of one number", drawn({"frame": 2, "point": [1]})


GOOD_LANDMARKS = b"name,x,y,z\nA,0,0,0\nB,50,0,0\nC,0,70,0\nD,10,20,30\n"


def landmarks():
    """Damaged lists of landmarks: (what is wrong, bytes)."""
    yield "empty", b""
    yield "a heading only", b"name,x,y,z\n"
    yield "comments only", b"# A,0,0,0\n"
    yield "a recording", b"ObjectType = Image\nNDims = 3\n"
    yield "bytes", bytes(range(256)) * 4
    yield "zeros", bytes(1000)
    for name, old, new in (("a word", b"50", b"fifty"), ("NaN", b"50", b"nan"), ("infinite", b"50", b"inf"),
                           ("beyond all numbers", b"50", b"1e999"), ("far away", b"50", b"1e9"), ("hexadecimal", b"50", b"0x50"),
                           ("a missing value", b"B,50,0,0", b"B,50,0"), ("an empty value", b"B,50,0,0", b"B,50,,0"),
                           ("a value too many", b"B,50,0,0", b"B,50,0,0,0"), ("decimal commas", b"B,50,0,0", b"B,50,5,0,0,0,0"),
                           ("a name twice", b"B,", b"A,"), ("a name missing", b"B,", b","), ("one without name", b"B,50", b"50"),
                           ("a long name", b"B,", b"B" * 201 + b","), ("a control character", b"B,", b"\x07,"),
                           ("cut short", b"D,10,20,30\n", b"D,10,20"), ("two landmarks", b"C,0,70,0\nD,10,20,30\n", b"")):
        yield name, GOOD_LANDMARKS.replace(old, new)
    yield "1001 landmarks", b"1,2,3\n" * 1001
    yield "a line of 900 kB", b"A," + b"1" * 900_000 + b",2,3\n"
    yield "more than 1 MB", b"#" * 1_000_001


def planes(good_text, frames):
    """Dividing planes for a recording of this many frames."""
    good = json.loads(good_text)

    def changed(**fields):
        return json.dumps({**good, **fields}).encode()

    def plane(**fields):
        return changed(dividing_planes=[{"normal": [1, 0, 0], "offset_mm": 2, **fields}])

    def sweeps(*ends):
        return changed(sweeps=[{"recording": 0, "first": first, "last": last} for first, last in ends])

    yield from broken_json(good_text)
    yield "no planes", json.dumps(without(good, "dividing_planes")).encode()
    yield "planes that are an object", changed(dividing_planes={})
    yield "more than 32 planes", changed(dividing_planes=[{"normal": [1, 0, 0], "offset_mm": i} for i in range(33)])
    yield "a normal without length", plane(normal=[0, 0, 0])
    yield "a normal of length 2", plane(normal=[2, 0, 0])
    yield "a normal of two numbers", plane(normal=[1, 0])
    yield "an offset that is a word", plane(offset_mm="far")
    yield "an offset of 1e300", plane(offset_mm=1e300)
    yield "sweeps that are a number", changed(sweeps=3)
    yield "a sweep that runs backward", sweeps((3, 2))
    yield "sweeps that overlap", sweeps((0, 3), (3, frames - 1))
    yield "a sweep beyond the recording", sweeps((0, frames))
    yield "a sweep of negative frames", sweeps((-2, 3))
    yield "a sweep of another recording", changed(sweeps=[{"recording": 1, "first": 0, "last": 2}])


def exams():
    """Exam files, of which none names a recording that is there."""
    good = {"fathom_exam": 1, "recordings": ["scan.mha"], "sweeps": [{"recording": 0, "first": 0, "last": 5}],
            "dividing_planes": [{"normal": [1, 0, 0], "offset_mm": 2}], "structures": "contours.json"}

    def changed(**values):
        return json.dumps({**good, **values}).encode()

    def planes(normal, offset=1):
        return changed(dividing_planes=[{"normal": normal, "offset_mm": offset}])

    def sweep(**values):
        return changed(sweeps=[{**good["sweeps"][0], **values}])

    yield from broken_json(json.dumps(good).encode())
    yield "another kind of file", b'{"fathom_contours": 1, "structures": []}'
    yield "of a version to come", changed(fathom_exam=2)
    yield "a recording that is missing", changed()
    for recordings in ([], "scan.mha", [7], [""], ["."], ["scan.mha"] * 2, ["../scan.mha"], ["/scan.mha"], ["a\n.mha"],
                       ["x" * 5000], [str(number) for number in range(1001)]):
        yield f"recordings {str(recordings)[:40]}", changed(recordings=recordings)
    yield "contours elsewhere", changed(structures="sub/../../contours.json")
    yield "a calibration that is an object", changed(calibration={})
    yield "a patient that is a number", changed(patient=7)
    for normal in ([1, 0], [0, 0, 0], [2, 0, 0], ["1", 0, 0], [None, 0, 0], 1, {}):
        yield f"a normal {normal}", planes(normal)
    yield "a plane too far away", planes([1, 0, 0], 1e300)
    yield "33 planes", changed(dividing_planes=good["dividing_planes"] * 33)
    yield "planes that are a text", changed(dividing_planes="none")
    for values in ({"first": 6}, {"first": -1}, {"last": 1e300}, {"first": 0.5}, {"last": "5"}, {"recording": 1},
                   {"recording": -1}):
        yield f"a sweep with {values}", sweep(**values)
    yield "sweeps that share frames", changed(sweeps=good["sweeps"] * 2)
    yield "1001 sweeps", changed(sweeps=[{"first": n, "last": n} for n in range(1001)])


def phantoms(good):
    """Fathom's files of wire phantoms; `good` is one as Python has it."""

    def changed(change):
        document = json.loads(json.dumps(good))
        change(document)
        return json.dumps(document).encode()

    def wire(name, **values):
        return name, changed(lambda document: document["patterns"][0]["wires"][1].update(values))

    yield from broken_json(json.dumps(good).encode())
    yield "of a version to come", changed(lambda document: document.update(fathom_phantom=2))
    yield "no patterns", changed(lambda document: document.pop("patterns"))
    yield "no pattern in the list", changed(lambda document: document.update(patterns=[]))
    yield "a pattern of two wires", changed(lambda document: document["patterns"][0]["wires"].pop())
    yield "the same pattern twice", changed(lambda document: document["patterns"].append(document["patterns"][0]))
    yield wire("a wire with a flat end", front=[3, 0])
    yield wire("a wire with a text", front=["3", 0, 20])
    yield wire("a wire of no length", front=[27, 40, 20], back=[27, 40, 20])
    yield wire("a middle wire outside of its N", front=[50, 0, 20])
    yield wire("a middle wire off the plane of its N", front=[27, 0, 30])
    name, content = wire("an infinite wire", front=["HUGE", 0, 20])
    yield name, content.replace(b'"HUGE"', b"1e999")
    yield "a registration of 15 numbers", changed(lambda document: document.update(phantom_to_reference=[0] * 15))
    yield "a registration of zeros", changed(lambda document: document.update(phantom_to_reference=[0] * 16))


def study_results(good_text):
    """Results of studies, as `fathom accuracy` writes and merges them."""
    good = json.loads(good_text)

    def changed(**values):
        return json.dumps({**good, **values}).encode()

    def with_case(**values):
        return changed(results=[{**good["results"][0], **values}, *good["results"][1:]])

    yield from broken_json(good_text)
    for key in good:
        yield f"no {key}", json.dumps(without(good, key)).encode()
        yield f"{key} that is null", changed(**{key: None})
        yield f"{key} that is an object", changed(**{key: {}})
    for key in ("samples", "seed", "cases"):
        for value in (-1, 0.5, "1", [1]):
            yield f"{key} {value!r}", changed(**{key: value})
        yield f"{key} beyond all numbers", changed(**{key: "HUGE"}).replace(b'"HUGE"', b"1e999")
    yield "more cases than the study has", changed(cases=good["cases"] + 1)
    yield "more samples than there are cases for", changed(samples=99999)
    yield "a version to come", changed(fathom_accuracy=2)
    yield "a study with a line break", changed(study="2.1\n2.2")
    yield "a program with control characters", changed(version="\u001b[2J\n")
    for shard in ([1, 1], [-1, 2], [0, 0], [0, 2], [0], [0, 1, 2], ["0", "1"], [0, 10**12]):
        yield f"shard {shard}", changed(shard=shard)
    for number in (-1, 10**12, 0.5, "0", None, 1):
        yield f"case {number!r}", with_case(case=number)
    for value in (None, 1, "x", [], {}, {"error_percent": 7}, {"error_percent": {}}, {"error_percent": {"linear_planimetry": "x"}}):
        yield f"value {value!r}", with_case(value=value)
