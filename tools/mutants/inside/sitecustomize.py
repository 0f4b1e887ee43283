"""Python imports this at its start: while blocks are recorded, modules of the tree are compiled with probes.

Files of the tree that are opened count as well. A Python source counts if a test or a tool reads it. It does not count
if Python imports it, or if the package reads it for a digest.
"""

import ast
import json
import os
import sys
from importlib.machinery import SourceFileLoader
from pathlib import Path
from typing import Any

_plain = SourceFileLoader.source_to_code


def _with_probes(self: SourceFileLoader, data: Any, path: Any, *, _optimize: int = -1) -> Any:
    first = _first.get(str(path))
    if first is None:
        return _plain(self, data, path, _optimize=_optimize)
    from blocks import instrument

    tree = ast.parse(data)
    instrument(tree, first)
    return compile(tree, path, "exec", dont_inherit=True, optimize=_optimize)


def _note_file(event: str, arguments: tuple[Any, ...]) -> None:
    """Set the byte of a file that is opened."""
    if event != "open" or not isinstance(arguments[0], str):
        return
    index = _files.get(os.path.abspath(arguments[0]))  # noqa: PTH100 - called for each file
    probes = sys.modules.get("block_probes")
    if index is not None and probes is not None and (not arguments[0].endswith(".py") or _is_read_as_text()):
        probes.hits[index] = 1


def _is_read_as_text() -> bool:
    """Return True if the innermost code of the tree is that of a test or of a tool, and Python imports nothing."""
    frame = sys._getframe(2)
    while frame is not None:
        path = frame.f_code.co_filename
        if path.startswith("<frozen importlib"):
            return False
        if path.startswith(_root):
            return path.startswith((f"{_root}/tests/", f"{_root}/tools/"))
        frame = frame.f_back
    return False


if "BLOCKS_TABLE" in os.environ:
    _table = json.loads(Path(os.environ["BLOCKS_TABLE"]).read_text())
    _first, _files, _root = _table["modules"], _table["files"], os.environ["BLOCKS_ROOT"]
    SourceFileLoader.source_to_code = _with_probes
    sys.addaudithook(_note_file)
