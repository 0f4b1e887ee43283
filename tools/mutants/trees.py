"""A copy of a checkout, in which tests run on its own package."""

import os
import shutil
from collections.abc import Mapping
from pathlib import Path

PACKAGES = ("hydra_plugins", "runner")
INSIDE = Path(__file__).resolve().parent / "inside"
_LEFT_OUT = ("*cache*", ".git", ".venv", ".hypothesis", "outputs", "build", "dist", "site")


def copy_tree(tree: Path, to: Path) -> None:
    """Copy a checkout without what is made there, and without what `inside` brings again."""
    shutil.copytree(tree, to, symlinks=True, ignore=_left_out)


def _left_out(folder: str, names: list[str]) -> set[str]:
    top = "pyproject.toml" in names
    return set(shutil.ignore_patterns(*(_LEFT_OUT if top else ("__pycache__",)))(folder, names))


def modules(tree: Path) -> list[str]:
    """Return the paths of all modules of the packages, sorted."""
    return sorted(str(path.relative_to(tree)) for name in PACKAGES for path in (tree / name).rglob("*.py"))


def helpers(tree: Path) -> list[str]:
    """Return the paths of the modules that tests use besides the packages, sorted; those of `inside` are left out."""
    found = [path for name in ("tests/support", "tools", "bench") for path in (tree / name).rglob("*.py")]
    return sorted(str(path.relative_to(tree)) for path in found if path.parent.name != INSIDE.name)


def files(tree: Path) -> list[str]:
    """Return the paths of all files of a copy, sorted."""
    return sorted(str(path.relative_to(tree)) for path in tree.rglob("*") if path.is_file() and path.suffix != ".pyc")


def python(tree: Path) -> Path:
    """Return the interpreter of a checkout."""
    return tree / ".venv" / "bin" / "python"


def environment(copy: Path, scratch: Path, own: Mapping[str, str]) -> dict[str, str]:
    """Return the variables for tests of a copy: its package comes first, what they write goes to `scratch`."""
    given = {key: value for key, value in os.environ.items() if not key.startswith(("PYTEST_", "BLOCKS_", "RUNNER_"))}
    threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    places = {
        "PYTHONPATH": f"{copy}{os.pathsep}{INSIDE}",
        "XDG_CACHE_HOME": str(scratch / "cache"),
        "HOME": str(scratch),
    }
    return {**given, **threads, **places, "HYDRA_FULL_ERROR": "1", "TMPDIR": str(scratch), **own}
