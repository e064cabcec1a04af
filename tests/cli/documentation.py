#!/usr/bin/env python3
"""What the documentation shows works: README's sample, and every command of the user guide as it stands there."""

import re
import shlex

from program import Program, run_script


def code_blocks(text, language):
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


def squeezed(code):
    return "\n".join(line.strip() for line in code.splitlines() if line.strip())


def readme_sample(program, folder, tally, root, sample):
    shown = code_blocks((root / "README.md").read_text(), "cpp")
    built = (root / "tests" / "cli" / "readme_sample.cpp").read_text()
    tally.check("README has one C++ sample", len(shown) != 1 and f"it has {len(shown)}")
    tally.check("README's sample is the one that is built", squeezed(shown[0]) not in squeezed(built) and "it is not")
    tally.check("README's sample has eight lines", len(shown[0].splitlines()) > 8 and len(shown[0].splitlines()))
    program.must_run("simulate", "--object", "sphere", "--pattern", "linear", "--frames", 20, "--out",
                     folder / "sweep.mha")
    measured = program.must_run("measure", "sweep.mha", "--calibration", "sweep.calibration.json", "--contours",
                                "sweep.contours.json", "--json", cwd=folder).json()["structures"][0]
    said = Program(sample, program.sanitized).must_run(cwd=folder).out
    name, volume = said.removesuffix(" ml\n").rsplit(": ", 1)
    expected = measured["volume_ml"][measured["recommended"]]
    tally.check("README's sample measures as the command does",
                (name != measured["name"] or abs(float(volume) - expected) > 1e-4 * expected) and said)


def user_guide(program, folder, tally, root):
    guide = (root / "docs" / "user-guide.md").read_text()
    commands = [line for block in code_blocks(guide, "sh") for line in block.splitlines()]
    tally.check("the user guide shows commands", len(commands) < 5 and f"only {len(commands)}")
    for command in commands:
        name, *arguments = shlex.split(command)
        outcome = program.run(*arguments, cwd=folder)
        tally.check(f"user guide: {command}", (name != "fathom" or outcome.status != 0) and f"{outcome}")


def links(tally, root):
    """Links between the pages lead somewhere."""
    for page in [root / "README.md", root / "CONTRIBUTING.md", *sorted((root / "docs").glob("*.md"))]:
        for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text()):
            tally.check(f"{page.name} -> {target}", not (page.parent / target).exists() and "is not there")


def body(program, folder, tally, root, sample):
    readme_sample(program, folder, tally, root, sample)
    user_guide(program, folder, tally, root)
    links(tally, root)


if __name__ == "__main__":
    run_script(__doc__, body, "sample")
