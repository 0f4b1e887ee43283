"""Copy the examples to a folder: arm, controller, trajectory, paper and notebook.

Example: runner example examples
"""

import shutil
import sys
from argparse import Namespace
from pathlib import Path

from runner.base.atomic import write_atomically
from runner.base.errors import RunnerError
from runner.base.paths import examples_dir
from runner.cli.arguments import Parser


def add_arguments(parser: Parser) -> None:
    """Add the arguments."""
    parser.add_argument("folder", type=Path, metavar="DIR", help="a new folder, or an empty one")


def run(options: Namespace) -> int:
    """Copy the examples; print the folder as the last line."""
    folder: Path = options.folder
    copied = copy_examples(folder)
    print(f"runner: {len(copied)} files copied; {folder / 'own_robot' / 'README.md'} is a start", file=sys.stderr)
    print(folder)
    return 0


def copy_examples(folder: Path) -> list[Path]:
    """Copy the bundled examples; return the copies.

    Args:
        folder: Target folder; it is created if it does not exist.

    Raises:
        RunnerError: if the folder is not empty, or cannot be written to.
    """
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise RunnerError(f"{folder}: this folder is not empty. Allowed: a new folder, or an empty one.")
    source = examples_dir()
    found = sorted(path for path in source.rglob("*") if path.is_file() and "__pycache__" not in path.parts)
    copies = [folder / path.relative_to(source) for path in found]
    try:
        for path, copied in zip(found, copies, strict=True):
            copied.parent.mkdir(parents=True, exist_ok=True)
            write_atomically(copied, path.read_bytes())
            shutil.copymode(path, copied)
    except OSError as error:
        raise RunnerError(f"{folder}: cannot be written: {error.strerror}") from error
    return copies
