"""Where a result comes from: commit, versions, machine."""

import platform
import subprocess
from functools import cache
from importlib.metadata import version
from pathlib import Path

from runner.paths import package_dir

_LIBRARIES = ("arm-control-runner", "pybullet", "pin", "numpy", "scipy", "hydra-core")


@cache
def commit() -> str | None:
    """Return the checkout's commit, with "+changes" when files differ from it; None outside a checkout."""
    folder = package_dir().parent
    try:
        head = subprocess.run(
            ["git", "-C", str(folder), "rev-parse", "HEAD"], capture_output=True, text=True, check=True, timeout=10
        ).stdout.strip()
        changes = subprocess.run(
            ["git", "-C", str(folder), "status", "--porcelain", "--untracked-files=no"],
            capture_output=True,
            text=True,
            check=True,
            timeout=10,
        ).stdout.strip()
    except (OSError, subprocess.SubprocessError):
        return None
    return head + ("+changes" if changes else "")


@cache
def versions() -> dict[str, str]:
    """Return the versions of Python and of the libraries that results depend on."""
    return {"python": platform.python_version(), **{name: version(name) for name in _LIBRARIES}}


@cache
def machine() -> str:
    """Return the kind of machine: processor and system, no names."""
    processor = platform.machine()
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        processor = next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), processor)
    except OSError:
        pass
    return f"{processor}, {platform.system()} {platform.machine()}"
