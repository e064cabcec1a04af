#!/usr/bin/env python3
"""The accuracy laboratory: parts of a study that GNU parallel ran join to the bytes of one run, and what is wrong with
parts is said."""

import csv
import json
import os
import shutil
import subprocess

from program import complaint_about_error, run_script, tree

STUDY = ("--table", "2.13", "--samples", 1)  # some tenths of a second
PARTS = 4


def run_parts(program, folder, tally):
    """Whether GNU parallel ran all parts."""
    parallel = shutil.which("parallel")
    version = parallel and subprocess.run([parallel, "--version"], capture_output=True, text=True, check=False).stdout
    if not version or "GNU parallel" not in version:
        tally.skip("shards by GNU parallel", "the program `parallel` is not installed")
        return False
    environment = {**os.environ, "PARALLEL_HOME": str(folder / "parallel")}
    (folder / "parallel").mkdir()
    done = subprocess.run(
        [parallel, "--will-cite", "--jobs", "2", program.path, "accuracy", *map(str, STUDY), "--threads", "1", "--shard",
         f"{{}}/{PARTS}", "--out", str(folder / "parts"), ":::", *map(str, range(PARTS))],
        stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False, env=environment)
    tally.check("GNU parallel runs the shards", done.returncode != 0 and f"status {done.returncode}: {done.stderr}")
    return done.returncode == 0


def one_run(program, folder, tally):
    outcome = program.must_run("accuracy", *STUDY, "--threads", 3, "--out", folder / "one")
    names = set(tree(folder / "one"))
    wanted = {"2.13.json", "2.13.ends-steady-cubic.csv", "2.13.ends-steady-cubic.txt", "index.html", "results.md"}
    tally.check("a run writes results, tables and a page", wanted - names)
    tally.check("a run prints its tables", "| scale |" not in outcome.out and outcome.out)
    plots = {name for name in names if name.endswith(".svg")}
    if shutil.which("gnuplot"):
        tally.check("a run draws plots", not plots or [n for n in plots if b"<svg" not in tree(folder / "one")[n]])
    else:
        tally.check("without gnuplot there are no plots, which is said", plots or "gnuplot-nox" not in outcome.err)
    rows = list(csv.reader((folder / "one" / "2.13.ends-steady-cubic.csv").open(newline="")))
    tally.check("CSV is rectangular", len({len(row) for row in rows}) != 1 and f"{rows}")
    page = (folder / "one" / "index.html").read_text()
    tally.check("the page needs no other file", "src=\"http" in page or "href=\"http" in page)
    tally.check("the page says how it was made", "samples 1, seed 1" not in page and "it does not")


def shards(program, folder, tally):
    if not run_parts(program, folder, tally):
        for part in range(PARTS):
            program.must_run("accuracy", *STUDY, "--shard", f"{part}/{PARTS}", "--out", folder / "parts")
    parts = folder / "parts"
    tally.check("there is a file for each shard", len(list(parts.iterdir())) != PARTS and f"{tree(parts).keys()}")
    program.must_run("accuracy", "merge", parts, "--out", folder / "merged")
    tally.check("merged shards are one run, to the byte",
                [name for name, content in tree(folder / "one").items() if tree(folder / "merged").get(name) != content])
    files = sorted(parts.iterdir())
    program.must_run("accuracy", "merge", *reversed(files), "--out", folder / "again")
    tally.check("in any order", tree(folder / "again") != tree(folder / "merged") and "not the same")


def refused(program, folder, tally):
    parts = sorted((folder / "parts").iterdir())
    changed = folder / "changed"
    changed.mkdir()

    def with_change(name, change):
        document = json.loads(parts[1].read_text())
        change(document)
        (changed / name).write_text(json.dumps(document))
        return [parts[0], changed / name, *parts[2:]]

    cases = {
        "a part missing": (parts[1:], "0/4"),
        "a part twice": ([*parts, parts[2]], "too"),
        "a part and the whole": ([*parts, folder / "one" / "2.13.json"], "too"),
        "another version": (with_change("version.json", lambda d: d.update(version="0.0.1")), "0.0.1"),
        "another build": (with_change("build.json", lambda d: d.update(build="0123")), "build 0123"),
        "another seed": (with_change("seed.json", lambda d: d.update(seed=2)), "seed 2"),
        "another study": (with_change("study.json", lambda d: d.update(study="2.14")), "2.14"),
        "an unknown study": (with_change("unknown.json", lambda d: d.update(study="9.9")), "9.9"),
        "a case missing": (with_change("few.json", lambda d: d["results"].pop()), "few.json"),
        "rubbish for a value": (with_change("value.json", lambda d: d["results"][0].update(value="x")), "values"),
        "no results": ([folder / "one" / "results.md"], "results.md"),
        "an empty folder": ([folder / "parallel-none"], "parallel-none"),
        "no file": ([folder / "nothing.json"], "nothing.json"),
    }
    (folder / "parallel-none").mkdir()
    for name, (files, said) in cases.items():
        outcome = program.run("accuracy", "merge", *files, "--out", folder / "refused")
        complaint = complaint_about_error(outcome)
        if not complaint and said not in outcome.err:
            complaint = f"the message does not say {said!r}: {outcome.err}"
        if not complaint and (folder / "refused").exists():
            complaint = "a folder was left behind"
        tally.check(f"merge, {name}", complaint)


def wrong_lines(program, folder, tally):
    lines = ("", "--table", "--table banana", "--table 2.13 --all", "--table 2.13 --samples 0", "--table 2.13 --seed -1",
             "--table 2.13 --threads 0", "--table 2.13 --shard 0/3", "--table 2.13 --shard 4/3 --out x",
             "--table 2.13 --shard 3/3 --out x", "--table 2.13 --shard 1 --out x", "--table 2.13 --shard -1/3 --out x",
             "merge", "merge a.json", "list 3", "banana")
    for line in lines:
        outcome = program.run("accuracy", *line.split(), cwd=folder)
        tally.check(f"accuracy {line}", (outcome.status != 2 or not outcome.err or outcome.out) and f"{outcome}")
    tally.check("an unknown study is answered by those that there are",
                "2.1, 2.13, 2.14" not in program.run("accuracy", "--table", "banana").err)
    tally.check("nothing is written", (folder / "x").exists() and "x is")


def as_json(program, folder, tally):
    one = program.must_run("accuracy", *STUDY, "--json").json()
    tally.check("rows of one study", ("study" in one["rows"][0] or one["rows"][0]["scale"] != 1) and f"{one['rows'][0]}")
    two = program.must_run("accuracy", *STUDY, "--table", "2.14", "--json").json()
    tally.check("rows of two say of which", {row["study"] for row in two["rows"]} != {"2.13", "2.14"} and f"{two['rows']}")
    studies = [study["study"] for study in program.must_run("accuracy", "list", "--json").json()["studies"]]
    tally.check("studies are listed", "2.1" not in studies and f"{studies}")


def other_studies_of_the_folder(program, folder, tally):
    """A second run into a folder keeps the first study on the page, and says what it cannot show."""
    program.must_run("accuracy", "--table", "2.14", "--samples", 1, "--out", folder / "one")
    page = (folder / "one" / "index.html").read_text()
    tally.check("both studies are on the page", 'id="study-2.13"' not in page or 'id="study-2.14"' not in page)
    (folder / "one" / "2.13.json").write_text("{}")
    outcome = program.must_run("accuracy", "--table", "2.14", "--samples", 1, "--out", folder / "one")
    tally.check("what cannot be shown is said", "2.13.json" not in outcome.err and outcome.err)


def without_gnuplot(program, folder, tally):
    (folder / "plain").mkdir()
    (folder / "plain" / "2.13.ends-steady.svg").write_text("of an earlier run")
    path = os.environ["PATH"]
    os.environ["PATH"] = str(folder)
    try:
        outcome = program.must_run("accuracy", *STUDY, "--out", folder / "plain")
    finally:
        os.environ["PATH"] = path
    names = set(tree(folder / "plain"))
    tally.check("without gnuplot tables are written", "2.13.ends-steady-cubic.csv" not in names and f"{names}")
    tally.check("and it is said what to install", "gnuplot-nox" not in outcome.err and outcome.err)
    tally.check("and nothing of plots is left", [name for name in names if name.endswith((".svg", ".gp", ".log"))])


def unfinished(program, folder, tally):
    """A run that does not end well leaves no files, and earlier ones as they were."""
    target = folder / "cut"
    target.mkdir()
    (target / "2.1.json").write_text("old")
    before = tree(target)
    outcome = program.run("accuracy", "--table", "2.1", "--out", target,
                          interrupt_after=lambda: any(path.name.startswith(".cut.") for path in folder.iterdir()))
    tally.check("Ctrl-C", complaint_about_error(outcome) or (tree(target) != before and f"{sorted(tree(target))}"))
    tally.check("Ctrl-C leaves no hidden folder", [path.name for path in folder.iterdir() if path.name.startswith(".")])
    outcome = program.run("accuracy", *STUDY, "--out", target, max_file_bytes=1000)
    tally.check("files limited to 1 kB",
                complaint_about_error(outcome) or (tree(target) != before and f"{sorted(tree(target))}"))
    outcome = program.run("accuracy", *STUDY, "--out", target / "2.1.json")
    tally.check("a file in the folder's place",
                complaint_about_error(outcome) or (tree(target) != before and f"{sorted(tree(target))}"))


def body(program, folder, tally, _root):
    one_run(program, folder, tally)
    shards(program, folder, tally)
    refused(program, folder, tally)
    wrong_lines(program, folder, tally)
    as_json(program, folder, tally)
    unfinished(program, folder, tally)
    without_gnuplot(program, folder, tally)
    other_studies_of_the_folder(program, folder, tally)


if __name__ == "__main__":
    run_script(__doc__, body)
