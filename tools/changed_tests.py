"""The tests that a change can affect, by the coverage map: `make test-changed`.

`python -m tools.changed_tests [BASE]` compares the checkout with a commit, HEAD without one. It runs the tests that run
a changed function or read a changed file, and all tests of changed test files. It prints what it left out.
"""

import ast
import hashlib
import subprocess
import sys
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tools.mutants.choosing import CoverageMap, imported, short, test_files
from tools.mutants.inside.blocks import mark
from tools.mutants.recording import PLACE

ROOT = Path(__file__).resolve().parents[1]
AT_IMPORT = ""  # owner of what runs when a module is imported
DOCSTRINGS = "docstrings"  # owner of the docstrings of a module and its classes, which the package prints
_READS_DOCSTRINGS = ("__doc__", "getdoc")
_FOR_ALL = ("pyproject.toml", "constraints.txt", "tests/conftest.py")


def main(arguments: list[str]) -> int:
    """Run the tests that a change can affect; return pytest's exit code, and 2 without a map."""
    base = arguments[0] if arguments else "HEAD"
    if not (ROOT / PLACE).is_file():
        print(f"make test-changed: no {PLACE}, the tests that run each line; `make coverage-map` records it")
        return 2
    known = CoverageMap.load(ROOT)
    try:
        changed = changes(base)
    except subprocess.CalledProcessError as error:
        print(f"make test-changed: BASE: {error.stderr.strip().splitlines()[0]}")
        return 2
    chosen = choose(known, changed, ROOT)
    files = test_files(ROOT)
    own = {Path(path).name for path in changed if Path(path).name in files and path.startswith("tests/")}
    new = sorted(files.keys() - {test.partition("::")[0] for test in known.tests} - own)
    collected = [files[name] for name in sorted(own | {test.partition("::")[0] for test in chosen} & files.keys())]
    print("\n".join(report(known, changed, chosen, own, new)))
    if not collected:
        return 0
    code = pytest.main(["-q", *collected], plugins=[_Selection(known, chosen, own)])
    return 0 if code == pytest.ExitCode.NO_TESTS_COLLECTED else int(code)


def changes(base: str, root: Path = ROOT) -> dict[str, tuple[str, str]]:
    """Return the text of each changed file at a commit and now, by path; empty where there is none."""
    listed = _git(root, "diff", "--name-only", "-z", base) + _git(root, "ls-files", "-zo", "--exclude-standard")
    return {path: (_at(root, base, path), _now(root / path)) for path in sorted({*listed.split("\0")} - {""})}


def choose(known: CoverageMap, changed: Mapping[str, tuple[str, str]], root: Path) -> set[str]:
    """Return the short names of the tests that changed files can affect.

    Args:
        known: The coverage map.
        changed: Text of each file before and now.
        root: The checkout.
    """
    chosen = np.zeros(len(known.tests), dtype=bool)
    paths, tests = {text.rsplit(":", 2)[0] for text in known.blocks}, test_files(root)
    for path, (before, now) in changed.items():
        folder = f"{Path(path).parent}/"
        beside = [known.files.index(path)] if path in known.files else []
        if not before or not now:  # whoever looks through the folder sees another file
            beside = [index for index, file in enumerate(known.files) if f"{Path(file).parent}/" == folder]
        chosen |= known.read[:, beside].any(axis=1)
        owners = changed_owners(before, now) if path.endswith(".py") else set()
        if AT_IMPORT in owners:
            names = {path, path.removeprefix("tests/")}
            users = {file for file in paths if path == file or names & _imported(root / file)}
            chosen |= _running(known, lambda file, _, users=users: file in users)
            asking = {name for name, file in tests.items() if names & _imported(root / file)}
            chosen |= [test.partition("::")[0] in asking for test in known.tests]
        if DOCSTRINGS in owners:
            readers = set(_readers(root, paths))
            chosen |= _running(known, lambda file, owner, readers=readers: (file, owner) in readers)
        chosen |= _running(known, lambda file, owner, path=path, owners=owners: file == path and owner in owners)
    return {known.tests[index] for index in np.flatnonzero(chosen)}


def changed_owners(before: str, now: str) -> set[str]:
    """Return the functions of a module that changed, AT_IMPORT for what runs on import, and DOCSTRINGS.

    A function that is new or gone counts as AT_IMPORT, because others may find it by its name.
    """
    one, other = (_digests(text) for text in (before, now))
    found = {owner for owner in one.keys() | other.keys() if one.get(owner) != other.get(owner)}
    unpaired = found & (one.keys() ^ other.keys())
    return found - unpaired | ({AT_IMPORT} if unpaired else set())


def _digests(source: str) -> dict[str, str]:
    """Return a digest of each function by its dotted name, of what runs on import, and of docstrings."""
    try:
        tree = ast.parse(source)
    except SyntaxError:
        return {AT_IMPORT: source, DOCSTRINGS: ""}
    texts: dict[str, list[str]] = {AT_IMPORT: [], DOCSTRINGS: []}
    for owner, node in _parts(tree, ""):
        texts.setdefault(owner, []).append(node if isinstance(node, str) else ast.dump(node))
    return {owner: hashlib.sha256("\0".join(parts).encode()).hexdigest() for owner, parts in texts.items()}


def _parts(node: Any, owner: str) -> Iterator[tuple[str, Any]]:
    """Yield the statements of a module or class with the function that they belong to."""
    body = list(node.body)
    if isinstance(body[0] if body else None, ast.Expr) and isinstance(body[0].value, ast.Constant):
        text = body.pop(0).value.value
        if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield DOCSTRINGS, str(text)
    inside = isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
    for statement in body:
        if isinstance(statement, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            name = f"{owner}.{statement.name}".lstrip(".")
            heading = [*statement.decorator_list, *getattr(statement, "bases", []), getattr(statement, "args", None)]
            place = owner if inside else AT_IMPORT
            yield place, " ".join([name, *(ast.dump(part) for part in heading if part is not None)])
            yield from _parts(statement, name)
        else:
            yield owner if inside else AT_IMPORT, statement


def _running(known: CoverageMap, counts: Any) -> np.ndarray[Any, Any]:
    """Return True for each test that runs a block whose module and owner count."""
    blocks = [index for index, text in enumerate(known.blocks) if counts(*text.rsplit(":", 2)[:2])]
    return np.asarray(known.ran[:, blocks].any(axis=1))


def _imported(module: Path) -> frozenset[str]:
    return imported(module) if module.is_file() else frozenset()


def _readers(root: Path, paths: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Yield module and name of each function that reads docstrings."""
    for path in paths:
        source = (root / path).read_text() if (root / path).is_file() else ""
        if any(name in source for name in _READS_DOCSTRINGS):
            tree = ast.parse(source)
            blocks = mark(tree)
            for node in ast.walk(tree):
                named = getattr(node, "attr", getattr(node, "id", None)) in _READS_DOCSTRINGS
                if named and getattr(node, "block", None) is not None:
                    yield path, blocks[node.block].owner


def report(
    known: CoverageMap, changed: Mapping[str, Any], chosen: set[str], whole: set[str], new: list[str]
) -> Iterator[str]:
    """Yield lines about what is chosen and what is left out."""
    cost = sum(cost for test, cost in zip(known.tests, known.costs, strict=True) if test in chosen)
    yield (
        f"{len(changed)} changed files: {len(chosen)} of {len(known.tests)} tests, {cost:.0f} of "
        f"{known.costs.sum():.0f} s of CPU time, and all of {len(whole)} changed test files"
    )
    yield (
        f"left out: {len(known.tests) - len(chosen)} tests that run no changed function and read no changed file, slow "
        "tests, and what processes without the map's probes read"
    )
    if new:
        yield f"left out: {len(new)} test files that are not in the map, {', '.join(new[:3])} ...: make coverage-map"
    if concerned := [path for path in _FOR_ALL if path in changed]:
        yield f"left out: most of what {' and '.join(concerned)} can affect, which is all tests: make test"


class _Selection:
    """Plug-in of pytest that takes the chosen tests, and all tests of some files."""

    def __init__(self, known: CoverageMap, chosen: set[str], whole: set[str]) -> None:
        self._known, self._chosen, self._whole = set(known.tests), chosen, whole

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Leave out what is not chosen; a test that the map does not know is taken."""
        items[:] = [item for item in items if self._counts(item.path.name, short(item.nodeid))]

    def _counts(self, file: str, test: str) -> bool:
        return file in self._whole or test in self._chosen or test not in self._known


def _git(root: Path, *words: str) -> str:
    return subprocess.run(["git", *words], cwd=root, check=True, capture_output=True, text=True).stdout


def _at(root: Path, base: str, path: str) -> str:
    shown = subprocess.run(["git", "show", f"{base}:{path}"], cwd=root, check=False, capture_output=True)
    return shown.stdout.decode(errors="replace") if shown.returncode == 0 else ""


def _now(path: Path) -> str:
    return path.read_text(errors="replace") if path.is_file() else ""


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
