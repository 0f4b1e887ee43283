"""The tests that may find a mutant, by the coverage map: the mirrored file's first, then those that run little."""

import ast
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from bench.mutants.mutant import Mutant
from bench.mutants.recording import PLACE


def short(test: str) -> str:
    """Return a test's name without folders, as base names of test files are unique and files move."""
    path, _, name = test.partition("::")
    return f"{path.rpartition('/')[2]}::{name}"


@dataclass(frozen=True)
class Choice:
    """Tests in the order in which they run.

    Attributes:
        files: Test files to collect.
        tests: Short names; None: all of the files.
        whole: Base names of files whose tests are also taken where the map does not know them.
        cost: CPU time that they took when the map was recorded [s].
    """

    files: tuple[str, ...]
    tests: tuple[str, ...] | None
    whole: tuple[str, ...] = ()
    cost: float = 0.0


@dataclass(frozen=True)
class CoverageMap:
    """Which test runs which block.

    Attributes:
        blocks: Keys of blocks.
        tests: Short names of tests.
        costs: CPU time of each test [s].
        ran: If test t runs block b, shape (tests, blocks).
    """

    blocks: tuple[str, ...]
    tests: tuple[str, ...]
    costs: np.ndarray[Any, Any] = field(repr=False)
    ran: np.ndarray[Any, Any] = field(repr=False)

    @classmethod
    def read(cls, tree: Path) -> "CoverageMap":
        """Return the map of a checkout."""
        with np.load(tree / PLACE, allow_pickle=False) as stored:
            blocks, tests = stored["blocks"].tolist(), stored["tests"].tolist()
            ran = np.unpackbits(stored["ran"], axis=1, count=len(blocks)).astype(bool)
            return cls(tuple(blocks), tuple(map(short, tests)), stored["costs"], ran)

    @classmethod
    def empty(cls) -> "CoverageMap":
        """Return the map that knows nothing, for mutants that name their test file."""
        return cls((), (), np.zeros(0), np.zeros((0, 0), dtype=bool))

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

    def running(self, blocks: Iterable[int]) -> np.ndarray[Any, Any]:
        """Return the indices of the tests that run any of some blocks."""
        chosen = list(blocks)
        return np.flatnonzero(self.ran[:, chosen].any(axis=1)) if chosen else np.array([], dtype=int)

    def covering(self, mutant: Mutant, tree: Path) -> np.ndarray[Any, Any]:
        """Return the indices of the tests that run a mutant.

        What runs at import counts for the functions of the module that use the name which is assigned there; where
        there are none for all functions of the module, and at last for those of the modules that import it.
        """
        owners = self._by_owner.get(mutant.path, {})
        if mutant.block is not None:
            if mutant.owner in owners:
                own = owners[mutant.owner]
                return self.running([own[mutant.block]] if mutant.block in own else own.values())
            return self._of_owners(mutant.path, owners)
        users = _users(ast.parse((tree / mutant.path).read_text()), mutant.name) if mutant.name else set()
        importers = [path for path in self._by_owner if mutant.path in _imported(tree, path)]
        nearest = self._of_owners(mutant.path, users)
        if not len(nearest):
            nearest = self._of_owners(mutant.path, owners)
        return (
            nearest
            if len(nearest)
            else np.unique(
                np.concatenate([nearest, *(self._of_owners(path, self._by_owner[path]) for path in importers)])
            )
        )

    def _of_owners(self, path: str, owners: Iterable[str]) -> np.ndarray[Any, Any]:
        known = self._by_owner.get(path, {})
        return self.running(index for owner in owners for index in known.get(owner, {}).values())

    def choose(self, mutant: Mutant, tree: Path, limit: float, without: Iterable[str] = ()) -> Choice | None:
        """Return the tests for a mutant, until they take a limit of CPU time [s]; None where none runs it."""
        files = test_files(tree)
        if mutant.test is not None:
            file = files[Path(mutant.test).name]
            return Choice((file,), None)
        mirrors = _mirrors(mutant.path, files)
        own = {Path(file).name for file in mirrors}
        left_out = set(without)
        found = [
            index
            for index in self.covering(mutant, tree)
            if self.tests[index] not in left_out and self.tests[index].partition("::")[0] in files
        ]
        found.sort(key=lambda index: self._rank(index, own))
        total = np.cumsum([self.costs[index] for index in found])
        found = found[: max(1, int(np.searchsorted(total, limit, side="right")))]
        tests = tuple(self.tests[index] for index in found)
        if not tests and not mirrors:
            return None
        chosen = dict.fromkeys([*mirrors, *(files[test.partition("::")[0]] for test in tests)])
        return Choice(tuple(chosen), tests, tuple(sorted(own)), float(total[len(found) - 1]) if found else 0.0)

    def _rank(self, index: int, mirrored: set[str]) -> tuple[bool, float]:
        """Return what orders tests: the mirrored file first, then cheap ones that run little."""
        apart = self.tests[index].partition("::")[0] not in mirrored
        return apart, float((self.costs[index] + 0.01) * self._breadth[index])


def test_files(tree: Path) -> dict[str, str]:
    """Return the path of each test file by its base name."""
    return {path.name: str(path.relative_to(tree)) for path in sorted((tree / "tests").rglob("test_*.py"))}


def _mirrors(module: str, files: dict[str, str]) -> list[str]:
    """Return the test files that have a module's name and lie in a folder with the name of one of its packages."""
    path = Path(module)
    named = files.get(f"test_{path.stem}.py")
    packages = set(path.parent.parts[1:])
    return [named] if named is not None and (not packages or packages & set(Path(named).parts)) else []


def _users(tree: ast.Module, name: str) -> set[str]:
    """Return the functions of a module that read a name, or that have it."""
    from bench.mutants.inside.blocks import mark

    blocks = mark(tree)
    found = {block.owner for block in blocks if name in block.owner.split(".")}
    for node in ast.walk(tree):
        read = getattr(node, "id", getattr(node, "attr", None)) == name and isinstance(node.ctx, ast.Load)
        if read and node.block is not None:
            found.add(blocks[node.block].owner)
    return found


_IMPORTED: dict[Path, set[str]] = {}


def _imported(tree: Path, path: str) -> set[str]:
    """Return the modules of the packages that a module imports by name, as paths."""
    place = tree / path
    if place not in _IMPORTED:
        names: set[str] = set()
        for node in ast.walk(ast.parse(place.read_text())):
            if isinstance(node, ast.ImportFrom) and node.module:
                names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
            elif isinstance(node, ast.Import):
                names |= {alias.name for alias in node.names}
        stems = {name.replace(".", "/") for name in names}
        _IMPORTED[place] = {f"{stem}.py" for stem in stems} | {f"{stem}/__init__.py" for stem in stems}
    return _IMPORTED[place]
