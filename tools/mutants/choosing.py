"""The tests that may find a mutant, by the coverage map: the mirrored file's first, then those that run little."""

import ast
import functools
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from tools.mutants.inside.blocks import mark
from tools.mutants.mutant import Mutant
from tools.mutants.recording import PLACE

_LEAST = 0.01  # CPU time that any test counts for [s]


def short(test: str) -> str:
    """Return a test's name without folders, because files move and their names are unique."""
    path, _, name = test.partition("::")
    return f"{path.rpartition('/')[2]}::{name}"


@dataclass(frozen=True)
class Choice:
    """Tests in the order in which they run.

    Attributes:
        files: Test files to collect.
        tests: Short names.
        whole: Base names of files whose tests run before, except for those that the map knows.
        cost: CPU time that they took when the map was recorded [s].
    """

    files: tuple[str, ...]
    tests: tuple[str, ...]
    whole: tuple[str, ...] = ()
    cost: float = 0.0


@dataclass(frozen=True)
class CoverageMap:
    """Blocks that each test runs.

    Attributes:
        blocks: Keys of blocks.
        tests: Short names of tests.
        costs: CPU time of each test, shape (tests,) [s].
        ran: True where a test runs a block, shape (tests, blocks).
        files: Paths of all files.
        read: True where a test reads a file, shape (tests, files).
        passed: True for a test that passed, shape (tests,).
    """

    blocks: tuple[str, ...] = ()
    tests: tuple[str, ...] = ()
    costs: np.ndarray[Any, Any] = field(default_factory=lambda: np.zeros(0))
    ran: np.ndarray[Any, Any] = field(default_factory=lambda: np.zeros((0, 0), dtype=bool))
    files: tuple[str, ...] = ()
    read: np.ndarray[Any, Any] = field(default_factory=lambda: np.zeros((0, 0), dtype=bool))
    passed: np.ndarray[Any, Any] = field(default_factory=lambda: np.zeros(0, dtype=bool))

    @classmethod
    def load(cls, tree: Path) -> "CoverageMap":
        """Return the map of a checkout."""
        with np.load(tree / PLACE, allow_pickle=False) as stored:
            blocks, tests, files = (stored[name].tolist() for name in ("blocks", "tests", "files"))
            ran = np.unpackbits(stored["ran"], axis=1, count=len(blocks)).astype(bool)
            read = np.unpackbits(stored["read"], axis=1, count=len(files)).astype(bool)
            return cls(
                tuple(blocks), tuple(map(short, tests)), stored["costs"], ran, tuple(files), read, stored["passed"]
            )

    def of_passed(self) -> "CoverageMap":
        """Return the map without what tests run that failed or were skipped: they find no mutant."""
        return replace(self, ran=self.ran & self.passed[:, None])

    @cached_property
    def _by_owner(self) -> dict[str, dict[str, dict[int, int]]]:
        """Index of each block by module, owner and ordinal."""
        found: dict[str, dict[str, dict[int, int]]] = {}
        for index, text in enumerate(self.blocks):
            path, owner, ordinal = text.rsplit(":", 2)
            found.setdefault(path, {}).setdefault(owner, {})[int(ordinal)] = index
        return found

    @cached_property
    def _breadth(self) -> np.ndarray[Any, Any]:
        return self.ran.sum(axis=1)

    def covering(self, mutant: Mutant, tree: Path) -> list[int]:
        """Return the indices of the tests that run a mutant.

        A statement that runs at import counts for the functions of the module that use the name assigned there. If no
        test runs these, it counts for all functions of the module, else for those of the modules that import it.
        """
        owners = self._by_owner.get(mutant.path, {})
        if mutant.block is not None and mutant.owner in owners:
            own = owners[mutant.owner]
            return self._running([own[mutant.block]] if mutant.block in own else own.values())
        users = _users((tree / mutant.path).read_text(), mutant.name) if mutant.name else set()
        return (
            self._of_owners(mutant.path, users)
            or self._of_owners(mutant.path, owners)
            or sorted({test for path in self._by_owner if mutant.path in imported(tree / path)
                       for test in self._of_owners(path, self._by_owner[path])})
        )  # fmt: skip

    def _of_owners(self, path: str, owners: Iterable[str]) -> list[int]:
        known = self._by_owner.get(path, {})
        return self._running(index for owner in owners for index in known.get(owner, {}).values())

    def _running(self, blocks: Iterable[int]) -> list[int]:
        chosen = list(blocks)
        return np.flatnonzero(self.ran[:, chosen].any(axis=1)).tolist() if chosen else []

    def choose(self, mutant: Mutant, tree: Path, limit: float, without: Iterable[str] = ()) -> Choice | None:
        """Return the tests for a mutant, until they take a limit of CPU time [s]; None where none runs it."""
        files = test_files(tree)
        if mutant.test is not None:
            file = files[Path(mutant.test).name]
            return Choice((file,), (), (Path(file).name,))
        mirrored, left_out = _mirror(mutant.path, files), set(without)
        whole = () if mirrored is None else (mirrored,)
        found = [
            index
            for index in self.covering(mutant, tree)
            if self.tests[index] not in left_out and _file(self.tests[index]) in files
        ]
        found.sort(key=lambda index: self._rank(index, mirrored))
        total = np.cumsum(self.costs[found])
        found = found[: max(1, int(np.searchsorted(total, limit, side="right")))]
        if not found and not whole:
            return None
        tests = tuple(self.tests[index] for index in found)
        collected = dict.fromkeys(files[name] for name in (*whole, *map(_file, tests)))
        return Choice(tuple(collected), tests, whole, float(total[len(found) - 1]) if found else 0.0)

    def _rank(self, index: int, mirrored: str | None) -> tuple[bool, float]:
        """Return the sort key of tests: the mirrored file first, then cheap ones that run little."""
        return _file(self.tests[index]) != mirrored, float((self.costs[index] + _LEAST) * self._breadth[index])


def test_files(tree: Path) -> dict[str, str]:
    """Return the path of each test file by its base name."""
    return {path.name: str(path.relative_to(tree)) for path in sorted((tree / "tests").rglob("test_*.py"))}


def _file(test: str) -> str:
    return test.partition("::")[0]


def _mirror(module: str, files: Mapping[str, str]) -> str | None:
    """Return the test file that has a module's name and lies in a folder with the name of one of its packages."""
    path, name = Path(module), f"test_{Path(module).stem}.py"
    packages = set(path.parent.parts[1:])
    return name if name in files and (not packages or packages & set(Path(files[name]).parts)) else None


def _users(source: str, name: str) -> set[str]:
    """Return the functions of a module that read a name, or that have it."""
    tree = ast.parse(source)
    blocks = mark(tree)
    found = {block.owner for block in blocks if name in block.owner.split(".")}
    for node in ast.walk(tree):
        read = getattr(node, "id", getattr(node, "attr", None)) == name and isinstance(node.ctx, ast.Load)
        if read and node.block is not None:
            found.add(blocks[node.block].owner)
    return found


@functools.cache
def imported(module: Path) -> frozenset[str]:
    """Return the modules of the packages that a module imports by name, as paths."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(module.read_text())):
        if isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
        elif isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
    stems = {name.replace(".", "/") for name in names}
    return frozenset({f"{stem}.py" for stem in stems} | {f"{stem}/__init__.py" for stem in stems})
