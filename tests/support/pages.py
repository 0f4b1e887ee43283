"""Pages of the documentation, followed command by command in one shell, like a reader.

A block that is indented by four spaces and begins with `$ ` holds commands, and below each what it prints: lines in
order, some of them left out; a line that ends in three dots is the start of one. A command ends with 0, or with
2 where the page shows problems in a config, or with what the page shows if the next command is `echo $?`. Commands that
only show what they do, because they take minutes or need own files of a reader, are between fences.
"""

import doctest
import os
import re
import subprocess
import sys
import traceback
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from support.patience import PATIENCE

ROOT = Path(__file__).resolve().parents[2]
BAD_INPUT = 2
_FOLDER = re.compile(r"\b(runs|sweeps|reports|tunings|calibrations)/[0-9a-f]{24}\b")
_ENDS_OF_DOCUMENT = re.compile(r"<<'(\w+)'")
_PYTHON = re.compile(r"^```python\n(.*?)^```", re.M | re.S)
_CODE_OF_THE_LAST = "echo $?"


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


def pages() -> list[Path]:
    """Return the README and the pages of docs/."""
    return [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


def steps(page: Path, until: str = "") -> list[Step]:
    """Return the commands of a page, or of its beginning up to the end of a section."""
    text = page.read_text(encoding="utf-8")
    if until:
        text = re.split(rf"(?<=^## {re.escape(until)}\n)(.*?)^## ", text, maxsplit=1, flags=re.M | re.S)
        text = "".join(text[:2])
    found: list[tuple[str, list[str]]] = []
    in_shell = False
    for line in text.splitlines():
        code = line.removeprefix("    ")
        typing = in_shell and _goes_on(found[-1][0])
        if not (typing or line.strip()):
            continue  # an empty line ends no block
        in_shell = typing or (code != line and (in_shell or code.startswith("$ ")))
        if typing:
            found[-1] = (f"{found[-1][0]}\n{code}", [])
        elif in_shell and code.startswith("$ "):
            found.append((code.removeprefix("$ "), []))
        elif in_shell:
            found[-1][1].append(code)
    return [Step(command, tuple(lines)) for command, lines in found]


def _goes_on(command: str) -> bool:
    """Return True if the shell waits for more of a command: after a backslash, or for the end of a document."""
    end = _ENDS_OF_DOCUMENT.search(command)
    return command.endswith("\\") if end is None else command.splitlines()[-1] != end[1]


def follow(some: Sequence[Step], folder: Path) -> list[Ended]:
    """Type commands in one shell that has HOME and PATH; continue whatever they end with.

    Args:
        some: The commands.
        folder: An empty folder. The shell begins in a checkout within it, which has the examples and all installed.
    """
    checkout, home, printed = (folder / name for name in ("checkout", "home", "printed"))
    for made in (checkout, home, printed):
        made.mkdir()
    (checkout / "Makefile").write_text("install:\n")
    (checkout / "examples").symlink_to(ROOT / "examples")
    lines = [
        f"{{ {step.command}\n}} > {printed}/{number} 2>&1 < /dev/null\n"
        f"code=$?; echo $code > {printed}/{number}.code; (exit $code)"
        for number, step in enumerate(some)
    ]
    given = {"HOME": str(home), "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.defpath}"}
    subprocess.run(["/bin/sh", "-c", "\n".join(lines)], cwd=checkout, env=given, timeout=PATIENCE * max(1, len(some)))
    return [
        Ended(step, (printed / str(number)).read_text(), int((printed / f"{number}.code").read_text()))
        for number, step in enumerate(some)
    ]


def complaints(followed: Sequence[Ended]) -> list[str]:
    """Return the errors of a page: a line that is not printed, or another exit code."""
    found = []
    for one, following in pairwise([*followed, None]):
        refused = any(re.search(r"\d problems? in the config", line) for line in one.step.shown)
        expected = BAD_INPUT if refused else 0
        if one.code != expected and (following is None or following.step.command != _CODE_OF_THE_LAST):
            found.append(f"$ {one.step.command}\nends with {one.code} instead of {expected}:\n{one.printed}")
        found += [
            f"$ {one.step.command}\ndoes not print, in its place,\n{line}\nbut\n{one.printed}"
            for line in first_missing(one.step.shown, one.printed)
        ]
    return found


def first_missing(shown: Sequence[str], text: str) -> list[str]:
    """Return the first shown line that a string does not have after those before it; none if it has all."""
    printed = iter(without_names(text).splitlines())
    return next(([line] for line in shown if not any(_is(line, other) for other in printed)), [])


def wrong_snippets(page: Path) -> list[str]:
    """Return the errors of the Python code of a page, run in the working directory.

    Examples behind `>>>` are compared with what they show, blocks between fences of python have to end; each kind is
    run in order, in one namespace.
    """
    text, found = page.read_text(encoding="utf-8"), []
    flags = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
    example = doctest.DocTestParser().get_doctest(text, {}, page.name, str(page), 0)
    doctest.DocTestRunner(optionflags=flags, verbose=False).run(example, out=found.append)
    names: dict[str, object] = {}
    for block in _PYTHON.findall(text):
        try:
            exec(compile(block, page.name, "exec"), names)
        except Exception:
            found.append(f"{block}\n{traceback.format_exc()}")
    return found


def has_python(page: Path) -> bool:
    """Return True if a page has snippets of Python."""
    text = page.read_text(encoding="utf-8")
    return ">>> " in text or _PYTHON.search(text) is not None


def without_names(text: str) -> str:
    """Return a string in which the names of stored folders, which follow from the source, are three dots."""
    return _FOLDER.sub(r"\1/...", text)


def _is(shown: str, line: str) -> bool:
    return line.startswith(shown.removesuffix("...")) if shown.endswith("...") else line == shown
