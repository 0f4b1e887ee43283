"""Habits that make a test depend on the machine, found in its syntax tree: sleeps, clocks, ports, endless waits."""

import ast
import itertools
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

_CLOCKS = {
    f"{name}{suffix}" for name in ("time", "monotonic", "perf_counter", "process_time") for suffix in ("", "_ns")
}
_CLOCKS.add("thread_time")
_WAITS = {"wait", "join", "communicate"}
_SLEEPS = re.compile(r"\btime\.sleep\(|\bimport\s+sleep\b")
_FREE = {"len"}  # functions that a `while` may call: they look at nothing outside


@dataclass(frozen=True)
class Offence:
    """An offence against a rule.

    Attributes:
        line: Its number.
        rule: The rule that it breaks.
    """

    line: int
    rule: str


def offences(source: str) -> list[Offence]:
    """Return all offences of a test file by line; in strings, which may be plug-ins, only sleeps."""
    tree = ast.parse(source)
    nodes = list(ast.walk(tree))
    found = [*_sleeps(nodes), *_waits(nodes), *_loops(nodes), *_ports(nodes)]
    if any(isinstance(node, ast.Name | ast.Attribute) and _name(node) in _CLOCKS for node in nodes):
        found += _asserted_clocks(tree)
    return sorted(set(found), key=lambda offence: (offence.line, offence.rule))


def _name(node: ast.expr) -> str:
    """Return the last name of what is called or taken: `sleep` of `time.sleep`."""
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""


def _calls(nodes: Iterable[ast.AST]) -> Iterator[tuple[ast.Call, str]]:
    for node in nodes:
        if isinstance(node, ast.Call):
            yield node, _name(node.func)


def _sleeps(nodes: Sequence[ast.AST]) -> Iterator[Offence]:
    for node in nodes:
        imported = isinstance(node, ast.ImportFrom) and any(alias.name == "sleep" for alias in node.names)
        called = isinstance(node, ast.Call) and _name(node.func) == "sleep"
        text = node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else ""
        if imported or called or _SLEEPS.search(text):
            yield Offence(node.lineno, "sleeps; wait for what is to happen")


def _waits(nodes: Sequence[ast.AST]) -> Iterator[Offence]:
    """Find waits whose limit is missing, or is a number: a limit that only ends hangs is PATIENCE."""
    for call, name in _calls(nodes):
        limits = [keyword.value for keyword in call.keywords if keyword.arg == "timeout"]
        if name in _WAITS and not isinstance(call.func, ast.Name):
            limits = limits or call.args[:1] if name != "communicate" else limits
            if not limits:
                yield Offence(call.lineno, f"{name} without a limit; give it PATIENCE")
        if any(isinstance(limit, ast.Constant) and isinstance(limit.value, int | float) for limit in limits):
            yield Offence(call.lineno, "a limit in seconds; give it PATIENCE")


def _loops(nodes: Sequence[ast.AST]) -> Iterator[Offence]:
    """Find `while` loops that ask again and again; those over what they hold themselves come to an end."""
    for node in nodes:
        if isinstance(node, ast.While):
            asked = {name for _, name in _calls(ast.walk(node.test))} - _FREE
            if asked or isinstance(node.test, ast.Constant):
                yield Offence(node.lineno, "a loop without a limit; use wait_until or `for _ in range`")


def _ports(nodes: Sequence[ast.AST]) -> Iterator[Offence]:
    """Find ports that a test chooses: bound and given to another, or written down."""
    for node in nodes:
        if isinstance(node, ast.Call) and _name(node.func) == "bind":
            yield Offence(node.lineno, "a chosen port; let the server choose it")
        words = node.elts if isinstance(node, ast.List | ast.Tuple) else node.args if isinstance(node, ast.Call) else []
        texts = [word.value if isinstance(word, ast.Constant) else None for word in words]
        for option, value in itertools.pairwise(texts):
            if option == "--port" and str(value) != "0":
                yield Offence(node.lineno, "a chosen port; let the server choose it")


def _asserted_clocks(tree: ast.AST) -> Iterator[Offence]:
    """Find comparisons with what a clock gave, also by way of a name in the same function."""
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)]
    for function in [tree, *functions]:
        timed: set[str] = set()
        for node in ast.walk(function):
            if isinstance(node, ast.Assign) and _reads_clock(node.value, set()):
                timed |= {name.id for target in node.targets for name in ast.walk(target) if isinstance(name, ast.Name)}
        for node in ast.walk(function):
            if isinstance(node, ast.Compare | ast.Assert) and _reads_clock(
                node, timed if function is not tree else set()
            ):
                yield Offence(node.lineno, "compares what a clock gave; count work, or hand in a clock")


def _reads_clock(tree: ast.AST, timed: set[str]) -> bool:
    """Return True if a clock of the module time is read, or a name that holds what one gave."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and _name(node.func) in _CLOCKS:
            of_time = not isinstance(node.func, ast.Attribute) or _name(node.func.value) == "time"
            if of_time:
                return True
        if isinstance(node, ast.Name) and node.id in timed:
            return True
    return False
