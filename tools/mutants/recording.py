"""Run all tests of a checkout once, and keep which blocks each runs and which files it reads: `make coverage-map`."""

import ast
import json
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tools.mutants.inside.blocks import mark
from tools.mutants.trees import copy_tree, environment, files, helpers, modules, python

PLACE = Path(".cache") / "coverage_map.npz"


def record(tree: Path, processes: int, tests: Sequence[str] = ()) -> None:
    """Write the map of a checkout to its `.cache/coverage_map.npz`."""
    with tempfile.TemporaryDirectory(prefix="coverage_map-") as folder:
        scratch = Path(folder).resolve()
        copy = scratch / "tree"
        copy_tree(tree, copy)
        first, blocks = _numbered(copy)
        read = {path: len(blocks) + index for index, path in enumerate(files(copy))}
        table = {
            "modules": {str(copy / path): index for path, index in first.items()},
            "files": {str(copy / path): index for path, index in read.items()},
        }
        (scratch / "table.json").write_text(json.dumps(table))
        kept = scratch / "cache"
        kept.mkdir()
        (kept / "arm-control-runner").touch()  # no folder: each process compiles, so that the laws' code runs in each
        own = {
            "BLOCKS_TABLE": str(scratch / "table.json"),
            "BLOCKS_ROOT": str(copy),
            "BLOCKS_FOLDER": str(scratch),
            "BLOCKS_COUNT": str(len(blocks) + len(read)),
        }
        options = ["-q", "-n", str(processes), "-p", "block_recorder", "-p", "no:cacheprovider", *tests]
        command = [python(tree), "-m", "pytest", *options]
        subprocess.run(command, cwd=copy, env=environment(copy, scratch, own), check=False)
        _write(tree / PLACE, blocks, list(read), list(_lines(scratch)))


def _numbered(tree: Path) -> tuple[dict[str, int], list[str]]:
    """Return the number of the first block of each module, and the keys of all blocks."""
    first: dict[str, int] = {}
    keys: list[str] = []
    for path in (*modules(tree), *helpers(tree)):
        first[path] = len(keys)
        keys += [key(path, block.owner, block.ordinal) for block in mark(ast.parse((tree / path).read_text()))]
    return first, keys


def key(path: str, owner: str, ordinal: int) -> str:
    """Return the name of a block, which stays the same where other functions of the module change."""
    return f"{path}:{owner}:{ordinal}"


def _lines(scratch: Path) -> Iterator[dict[str, Any]]:
    for path in sorted(scratch.glob("tests-*.jsonl")):
        yield from map(json.loads, path.read_text().splitlines())


def _write(place: Path, blocks: list[str], read: list[str], lines: list[dict[str, Any]]) -> None:
    hit = np.zeros((len(lines), len(blocks) + len(read)), dtype=bool)
    for row, line in zip(hit, lines, strict=True):
        row[line["blocks"]] = True
    passed = np.array([line["passed"] for line in lines], dtype=bool)
    place.parent.mkdir(exist_ok=True)
    np.savez_compressed(
        place,
        blocks=np.array(blocks),
        files=np.array(read),
        tests=np.array([line["test"] for line in lines]),
        costs=np.array([line["cpu"] for line in lines]),
        passed=passed,
        ran=np.packbits(hit[:, : len(blocks)], axis=1),
        read=np.packbits(hit[:, len(blocks) :], axis=1),
    )
    covered = int(hit[passed, : len(blocks)].any(axis=0).sum())
    print(f"{place}: {passed.sum()} of {len(lines)} tests passed, {covered} of {len(blocks)} blocks ran")
