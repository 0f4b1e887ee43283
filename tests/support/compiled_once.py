"""Keeps compiled modules, whatever the environment says: each process that a test starts would compile them again."""

import os
import shutil
import sys
from pathlib import Path

_PLACE = Path(__file__).resolve().parents[2] / ".pytest_cache" / "bytecode"

os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
os.environ["PYTHONPYCACHEPREFIX"] = sys.pycache_prefix = str(_PLACE)  # for processes to come, and for this one
sys.dont_write_bytecode = False


def forget(folder: Path) -> None:
    """Keep nothing of what lay in a folder that is used once."""
    shutil.rmtree(_PLACE / folder.relative_to("/"), ignore_errors=True)
