"""Files that a newcomer reads against what CONTRIBUTING.md says of them, and rules that hold for the whole source."""

import ast
import functools
import re
from pathlib import Path

from support.pages import ROOT

_TEXT = (ROOT / "CONTRIBUTING.md").read_text()
_SECTION = _TEXT.split("### Read these files in this order")[1].split("\n## ")[0]
FILES = [ROOT / path for path in re.findall(r"^\d+\. `([\w/.]+)`: .{20,}$", _SECTION, re.MULTILINE)]
_MOST_LINES, _LONGEST_FUNCTION = 2600, 60


@functools.cache
def nodes(file: Path) -> list[ast.AST]:
    return list(ast.walk(ast.parse(file.read_text(encoding="utf-8"))))


def functions(file):
    return [node for node in nodes(file) if isinstance(node, ast.FunctionDef)]


def test_there_are_nineteen_and_all_exist():
    assert len(FILES) == len(set(FILES)) == 19
    assert [file for file in FILES if not file.is_file()] == []
    assert len(re.findall(r"^\d+\. ", _SECTION, re.MULTILINE)) == 19


def test_they_are_read_in_an_afternoon():
    assert sum(len(file.read_text().splitlines()) for file in FILES) <= _MOST_LINES


def test_each_says_what_is_inside_and_has_short_functions():
    assert [file.name for file in FILES if not ast.get_docstring(nodes(file)[0])] == []
    lengths = {(file.name, node.name): node.end_lineno - node.lineno + 1 for file in FILES for node in functions(file)}
    assert {place: lines for place, lines in lengths.items() if lines > _LONGEST_FUNCTION} == {}


def test_each_is_typed_without_any():
    names = {(file.name, node.id) for file in FILES for node in nodes(file) if isinstance(node, ast.Name)}
    names |= {
        (file.name, alias.name)
        for file in FILES
        for node in nodes(file)
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    assert [place for place in names if place[1] in ("Any", "hasattr", "getattr")] == []


def test_a_value_by_joint_is_worked_out_once():
    keys = ("noise.position", "torque_limits.max")
    places = [
        (argument.value, path.stem)
        for path in (ROOT / "runner").rglob("*.py")
        if path.stem != "families" and any(key in path.read_text(encoding="utf-8") for key in keys)  # it changes them
        for node in nodes(path)
        if isinstance(node, ast.Call | ast.Tuple)
        for argument in (node.args if isinstance(node, ast.Call) else node.elts)
        if isinstance(argument, ast.Constant) and argument.value in keys
    ]
    assert sorted(places) == [("noise.position", "encoders"), ("torque_limits.max", "arms")]


def test_every_cache_of_a_module_is_bounded():
    unbounded = []
    for path in (ROOT / "runner").rglob("*.py"):
        for node in functions(path) if re.search("^ *@.*cache", path.read_text(encoding="utf-8"), re.MULTILINE) else ():
            decorators = [ast.unparse(decorator) for decorator in node.decorator_list]
            if {"cache", "functools.cache"} & {*decorators} and (node.args.args or node.args.vararg):
                unbounded.append(f"{path.name}: {node.name}")
            endless = any(re.fullmatch(r"lru_cache(\((maxsize=)?None\))?", text) for text in decorators)
            unbounded += [f"{path.name}: {node.name}"] if endless else []
    assert unbounded == []
