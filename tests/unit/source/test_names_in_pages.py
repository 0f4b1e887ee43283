"""Names in the code of the pages: each command, option, key, choice, metric and file exists."""

import argparse
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from support.pages import ROOT, pages, steps

from runner.cli import commands
from runner.cli.completion.overrides import metric_names
from runner.cli.parser import build_parser
from runner.config.compose.files import group_options, groups

GENERATED = ("reference.md", "architecture.md")
PAGES = [page for page in (*pages(), ROOT / "CONTRIBUTING.md", ROOT / "SECURITY.md") if page.name not in GENERATED]
OWN = {"pd", "spring", "my_panda", "lbr_iiwa", "line", *(path.stem for path in (ROOT / "examples").rglob("*.*"))}
"""Names that a page or an example creates."""
OWN_KEYS = {"controller.kp", "controller.kd"}
NO_KEYS = {"robot.model"}
"""Attributes in Python that look like keys."""
OTHER_OPTIONS = {"--enforce-costs", "--exclude", "--experimental-rerun", "--help"}
"""Options of pytest, pip and Hydra."""
MINUTES = ("runner reproduce", "runner tune", "runner study diff", "runner report latest")
"""Commands between fences, which no test follows."""
TOP = "runner|tests|conf|docs|examples|tools|robots|bench|\\.ci"
STAGES = "macro|mini|micro"


def keys() -> re.Pattern[str]:
    """Return a pattern of the keys of docs/reference.md and of the groups of keys above them."""
    listed = re.findall(r"^\| `([\w.]+)`", (ROOT / "docs" / "reference.md").read_text(encoding="utf-8"), re.M)
    above = {".".join(words[:end]) for words in (key.split(".") for key in listed) for end in range(2, len(words) + 1)}
    return re.compile(rf"(?:{'|'.join(sorted(key.replace('NAME', '[a-z0-9_]+') for key in above))})(?:\.(?:{STAGES}))?")


def options() -> set[str]:
    """Return the options of all commands and their actions."""
    parsers: list[argparse.ArgumentParser] = [*build_parser().commands.values()]
    found = set(OTHER_OPTIONS)
    for parser in parsers:
        for action in parser._actions:
            found.update(action.option_strings)
            if isinstance(action, argparse._SubParsersAction):
                parsers += action.choices.values()
    return found


def code(text: str) -> list[str]:
    """Return inline code, the commands of blocks, and commands without a prompt."""
    inline = re.findall(r"`([^`\n]+)`", re.sub(r"^```.*?^```", "", text, flags=re.M | re.S))
    return [*inline, *re.findall(r"^ *(?:\$ )?(runner (?!:).*)$", text, re.M)]


class Names:
    """All names that exist, and the problems of a page."""

    def __init__(self) -> None:
        self.keys, self.options, self.groups = keys(), options(), {*groups()}
        self.metrics = {*metric_names()}

    def problems(self, text: str) -> Iterator[str]:
        """Yield names in the code of a string that do not exist."""
        for line in code(text):
            yield from (
                f"command {name}"
                for name in re.findall(r"\brunner ([a-z]+)\b(?![=._/\w])", line)
                if name not in commands.names()
            )
            yield from (each for each in re.findall(r"(?<![\w-])--[a-z][a-z-]+", line) if each not in self.options)
            yield from self._keys(line)
            yield from self._choices(line)
            yield from self._metrics(line)
            for path in re.findall(rf"(?<![\w./-])(?:{TOP})/[\w./-]*\w", line):
                if not any((above / path).exists() for above in (ROOT, ROOT / "runner", ROOT / "conf")):
                    yield f"file {path}"

    def _keys(self, line: str) -> Iterator[str]:
        for group, rest in re.findall(r"(?<![\w./{$])([a-z_]+)\.([a-z][\w.]*\w)(?=[=`\s,]|$)", line):
            key = f"{group}.{rest}"
            known = self.keys.fullmatch(key) or key in OWN_KEYS | NO_KEYS or rest == "py"
            if group in self.groups and not known:
                yield f"key {key}"

    def _choices(self, line: str) -> Iterator[str]:
        for group, given in re.findall(r"(?<![\w./])([a-z_]+)=([\w,/.]+)", line):
            for choice in given.split(",") if group in self.groups and ".py" not in given else ():
                if choice and choice not in (*group_options(group), *OWN, "my_paper/fig3", "slower"):
                    yield f"{group}={choice}"

    def _metrics(self, line: str) -> Iterator[str]:
        asked = re.findall(r"--(?:metrics|minimize|maximize)[ =]([\w,]+)", line)
        shaped = re.findall(r"^(?:max|rms|peak)_\w+$", line)
        for name in ",".join([*asked, *shaped]).split(","):
            family = re.sub(r"(?:_(?:q\d|[xyz]|N|macro|mini|[23]d))+$", "", name)
            if re.search(r"[a-z]_", name) and family not in self.metrics:
                yield f"metric {name}"


@pytest.fixture(scope="module")
def names():
    return Names()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_name_in_the_code_of_a_page_exists(names, page):
    text = re.sub(r"^    #.*$|\w*/(?:NAME|STUDY)[/\w]*", "", page.read_text(encoding="utf-8"), flags=re.M)
    assert sorted(set(names.problems(text))) == []


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("`runner repot latest`", "command repot"),
        ("    $ runner report latest --formt html", "--formt"),
        ("`controller.perod`", "key controller.perod"),
        ("`noise.position.makro=1`", "key noise.position.makro"),
        ("    runner robot=makro", "robot=makro"),
        ("    $ runner table latest --metrics peak_torqe", "metric peak_torqe"),
        ("`runner/base/limit.py`", "file runner/base/limit.py"),
    ],
)
def test_a_name_that_does_not_exist_is_found(names, text, problem):
    assert [*names.problems(text)] == [problem]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_commands_that_no_test_follows_take_minutes(page):
    fences = re.findall(r"^```console\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S)
    followed = {step.command for step in steps(Path(page))}
    shown = [line.removeprefix("$ ") for fence in fences for line in fence.splitlines() if line.startswith("$ ")]
    assert [command for command in shown if not command.startswith(MINUTES) and command not in followed] == []
