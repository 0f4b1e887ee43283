"""Small errors put into the physics one at a time: each has to be found by the tests of the module that it is in.

A mutant is one text of a module replaced by another. It stands in a copy of the tree, so that the checkout stays as it
is, and the module's own test file runs there. What survives is named, and so is what stands nowhere any more.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path

from bench.mutants_list import MUTANTS, Mutant

_ROOT = Path(__file__).resolve().parents[1]
_TREE = ("bench", "conf", "hydra_plugins", "pyproject.toml", "reports", "robots", "runner", "tests")
_FAILED = 1  # pytest's exit code where tests failed; others tell that none ran


def main() -> bool:
    """Try every mutant and print what became of it; return whether all were found."""
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder)
        _copy(tree)
        broken = [test for test in sorted({mutant.test for mutant in MUTANTS}) if _run(tree, test) != 0]
        for test in broken:
            print(f"  {test} fails without a mutant")
        survivors = [] if broken else list(_survivors(tree))
    if not broken:
        print(f"{len(MUTANTS) - len(survivors)} of {len(MUTANTS)} mutants are found by the tests of their own module")
    return not broken and not survivors


def _survivors(tree: Path) -> Iterable[Mutant]:
    """Try each mutant, and give those that no test finds."""
    for mutant in MUTANTS:
        path = tree / mutant.module
        source = path.read_text()
        path.write_text(mutant.apply(source))
        found = _run(tree, mutant.test) == _FAILED
        path.write_text(source)
        print(f"  {'found' if found else 'SURVIVES':8} {mutant.module}: {mutant.why}", flush=True)
        if not found:
            yield mutant


def _copy(tree: Path) -> None:
    for name in _TREE:
        source = _ROOT / name
        if source.is_dir():
            shutil.copytree(source, tree / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, tree / name)


def _run(tree: Path, test: str) -> int:
    """Run a test file of the tree on the tree's own package; return pytest's exit code."""
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-x", "-n", "0", "-p", "no:cacheprovider", test],
        cwd=tree,
        env={**os.environ, "PYTHONPATH": str(tree), "PYTHONDONTWRITEBYTECODE": "1"},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        check=False,
    ).returncode
