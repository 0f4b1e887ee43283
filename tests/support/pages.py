"""Pages of the documentation, followed command by command in one shell, as a reader does."""

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
_FOLDER = re.compile(r"\b(runs|sweeps|reports|tunings|calibrations)/[0-9a-f]{24}\b")


@dataclass(frozen=True)
class Step:
    """A command of a page, and what the page shows that it prints, line by line."""

    command: str
    shown: tuple[str, ...]


@dataclass(frozen=True)
class Ended:
    """A command that was followed: what it printed, on both outputs, and its exit code."""

    step: Step
    printed: str
    code: int


def steps(page: Path, section: str = "") -> list[Step]:
    """Return the commands of a page, or of one section of it."""
    text = page.read_text(encoding="utf-8")
    if section:
        (text,) = re.findall(rf"^## {re.escape(section)}\n(.*?)(?=^## |\Z)", text, re.M | re.S)
    found: list[tuple[str, list[str]]] = []
    in_shell = False
    for line in text.splitlines():
        code = line.removeprefix("    ")
        in_shell = code != line and (in_shell or code.startswith("$ "))
        if in_shell and code.startswith("$ "):
            found.append((code.removeprefix("$ "), []))
        elif in_shell:
            found[-1][1].append(code)
    return [Step(command, tuple(lines)) for command, lines in found]


def follow(some: Sequence[Step], folder: Path, environment: Mapping[str, str]) -> list[Ended]:
    """Type some commands in one shell, `runner` and `python` being those of the tests; go on whatever they end with."""
    binaries, printed = folder / ".bin", folder / ".printed"
    binaries.mkdir()
    printed.mkdir()
    for name, words in (("python", ""), ("runner", "-m runner")):
        (binaries / name).write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} {words} "$@"\n')
        (binaries / name).chmod(0o755)
    lines = [
        f"{{ {step.command}\n}} > .printed/{number} 2>&1 < /dev/null; echo $? > .printed/{number}.code"
        for number, step in enumerate(some)
    ]
    path = f"{binaries}{os.pathsep}{os.environ['PATH']}"
    given = {**os.environ, "PYTHONPATH": str(ROOT), **environment, "PATH": path}
    subprocess.run(["/bin/sh", "-c", "\n".join(lines)], cwd=folder, env=given, check=True)
    return [
        Ended(step, (printed / str(number)).read_text(), int((printed / f"{number}.code").read_text()))
        for number, step in enumerate(some)
    ]


def without_names(text: str) -> str:
    """Return a text in which the names of stored folders, which follow from the source, are three dots."""
    return _FOLDER.sub(r"\1/...", text)


def is_shown(ended: Ended) -> bool:
    """Tell whether a page shows what a command printed: its lines in order; one that ends in three dots is a start."""
    printed = iter(without_names(ended.printed).splitlines())
    return all(any(_is(shown, line) for line in printed) for shown in ended.step.shown)


def _is(shown: str, line: str) -> bool:
    return line.startswith(shown.removesuffix("...")) if shown.endswith("...") else line == shown
