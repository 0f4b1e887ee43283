"""The twenty files of CONTRIBUTING.md that a newcomer reads are short, typed, and as it says."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
_TEXT = (ROOT / "CONTRIBUTING.md").read_text()
_SECTION = _TEXT.split("### Read these twenty files in this order")[1].split("###")[0]
FILES = [ROOT / path for path in re.findall(r"^\d+\. `([\w/.]+)`: .{20,}$", _SECTION, re.MULTILINE)]
_MOST_LINES, _LONGEST_FUNCTION = 2600, 60


def functions(file):
    return [node for node in ast.walk(ast.parse(file.read_text())) if isinstance(node, ast.FunctionDef)]


def test_there_are_twenty_and_all_exist():
    assert len(FILES) == len(set(FILES)) == 20
    assert [file for file in FILES if not file.is_file()] == []
    assert len(re.findall(r"^\d+\. ", _SECTION, re.MULTILINE)) == 20


def test_they_are_read_in_an_afternoon():
    assert sum(len(file.read_text().splitlines()) for file in FILES) <= _MOST_LINES


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.name)
def test_each_says_what_is_inside_and_has_short_functions(file):
    assert ast.get_docstring(ast.parse(file.read_text()))
    long = {node.name: node.end_lineno - node.lineno + 1 for node in functions(file)}
    assert {name: lines for name, lines in long.items() if lines > _LONGEST_FUNCTION} == {}


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.name)
def test_each_is_typed_without_any(file):
    nodes = list(ast.walk(ast.parse(file.read_text())))
    names = {node.id for node in nodes if isinstance(node, ast.Name)}
    names |= {alias.name for node in nodes if isinstance(node, ast.ImportFrom) for alias in node.names}
    assert not names & {"Any", "hasattr", "getattr"}


@pytest.mark.parametrize("key", ["noise.position", "torque_limits.max"])
def test_a_value_by_joint_is_worked_out_once(key):
    places = [
        path
        for path in (ROOT / "runner").rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Call)
        and getattr(node.func, "id", "") in ("by_stage", "expand")
        and any(isinstance(argument, ast.Constant) and argument.value == key for argument in node.args)
    ]
    assert [path.stem for path in places] == [key.partition(".")[0]]


def test_every_cache_of_a_module_is_bounded():
    unbounded = []
    for path in (ROOT / "runner").rglob("*.py"):
        for node in functions(path):
            decorators = [ast.unparse(decorator) for decorator in node.decorator_list]
            if {"cache", "functools.cache"} & {*decorators} and (node.args.args or node.args.vararg):
                unbounded.append(f"{path.name}: {node.name}")
            endless = any(re.fullmatch(r"lru_cache(\((maxsize=)?None\))?", text) for text in decorators)
            unbounded += [f"{path.name}: {node.name}"] if endless else []
    assert unbounded == []
