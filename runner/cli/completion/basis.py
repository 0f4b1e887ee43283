"""Digest of everything that the answer to a TAB depends on: the line, configs, robots, source and packages."""

import hashlib
import os
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from runner.base.paths import conf_dir, package_dir, robots_dir
from runner.config.compose.user_settings import user_overrides

_MOST = 1000  # files and folders of the user's config folders; with more, nothing is cached
_LARGEST = 20_000_000  # bytes of them
_INSTALLED = (".dist-info", ".egg-info", ".egg-link", ".pth")


def basis(typed: Sequence[str], config_dirs: Sequence[Path]) -> str | None:
    """Return a digest of a command line and of everything that may be read for it; None if that is too much to read.

    It covers the folder in which the line is typed, the user's settings, every file of our configs, URDFs and source,
    every file of the user's config folders, and the installed packages with their versions.

    Args:
        typed: The command line.
        config_dirs: Config folders of the user's that it names.
    """
    line = [*user_overrides(), *typed]
    digest = hashlib.sha256(repr((sys.version, sys.path, os.getcwd(), line, *_installed())).encode())  # noqa: PTH109
    for path in (*_tree(conf_dir()), *_tree(robots_dir()), *_tree(package_dir())):
        _add(digest, path)
    own = [path for folder in config_dirs for path in _tree(folder.resolve())]
    try:
        if len(own) > _MOST or sum(map(os.path.getsize, own)) > _LARGEST:
            return None
        for path in own:
            _add(digest, path)
    except OSError:  # a file that cannot be read, or is gone
        return None
    return digest.hexdigest()


def _add(digest: "hashlib._Hash", path: str) -> None:
    """Add a file's path and content to a digest; of a folder, its path."""
    content = b""
    if not path.endswith(os.sep):
        with open(path, "rb") as file:  # noqa: PTH123 - some 700 files, each time
            content = file.read()
    digest.update(b"%b\0%d\0%b" % (os.fsencode(path), len(content), content))


def _tree(root: Path) -> Iterator[str]:
    """Yield the paths of all folders, which end with a slash, and files below one, sorted; at most some."""
    count = 0
    for folder, folders, files in os.walk(root, followlinks=True):
        folders[:] = sorted(name for name in folders if name != "__pycache__")
        yield os.path.join(folder, "")  # noqa: PTH118
        yield from (os.path.join(folder, name) for name in sorted(files))  # noqa: PTH118
        count += 1 + len(files)
        if count > 10 * _MOST:
            return


def _installed() -> Iterator[tuple[str, str, int]]:
    """Yield where packages are installed, with their names, versions and times."""
    for place in sys.path:
        if os.path.isdir(place):  # noqa: PTH112
            with os.scandir(place) as entries:
                found = [(entry.name, entry.stat().st_mtime_ns) for entry in entries if entry.name.endswith(_INSTALLED)]
            yield from ((place, *each) for each in sorted(found))
