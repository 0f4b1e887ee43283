"""Make .venv, or mend it: `make install` runs this with the Python that .venv is to have.

It runs on any Python 3.6 or newer, to say which one is needed. A .venv that is sound stays; one whose Python is gone or
too old, or that was moved (its scripts name the folder that they were made in), is made anew.
"""

import hashlib
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
NEEDED = (3, 11)
_NO_NETWORK = re.compile(
    "name resolution|Name or service not known|establish a new connection|dns error|error sending request|client error|"
    "Network is unreachable|Connection refused|timed out|Could not fetch URL|Failed to fetch"
)


class InstallError(Exception):
    """What keeps .venv from being made, in a line that says what to do."""


def main(arguments: list) -> int:
    """Make .venv fit; return the exit code.

    Args:
        arguments: "--any-version" lets a sound .venv stay whatever its Python; else it has the version of this one.
    """
    try:
        install(ROOT, "--any-version" in arguments)
    except InstallError as failure:
        print(f"make install: {failure}", file=sys.stderr)
        return 2
    return 0


def install(root: Path, any_version: bool) -> None:
    """Make or mend the .venv of a checkout; see main."""
    venv, stamp = root / ".venv", root / ".venv" / ".installed"
    reason = why_anew(venv, any_version)
    if not reason and stamp.is_file() and stamp.read_text() == digest(root):
        return
    if reason or not venv.exists():
        require(sys.version_info[:2], sys.executable)
    if reason:
        print(f"make install: .venv is made anew: {reason}", file=sys.stderr)
        shutil.rmtree(str(venv))
    if not (venv / "bin" / "pip").exists():
        run([sys.executable if not venv.exists() else str(venv / "bin" / "python"), "-m", "venv", str(venv)], root)
    fetch(root, venv)
    stamp.write_text(digest(root))


def why_anew(venv: Path, any_version: bool) -> str:
    """Return why a .venv cannot stay; empty where it can, or there is none."""
    if not venv.exists():
        return ""
    found = version_of(venv / "bin" / "python")
    if found is None:
        return "its Python is gone"
    if found < NEEDED or not (any_version or found == sys.version_info[:2]):
        return f"it has Python {dotted(found)}"
    pip = venv / "bin" / "pip"
    named = re.search(r"(/.*?)/bin/python", pip.read_text(errors="replace")) if pip.is_file() else None
    if named and not (os.path.exists(named.group(1)) and os.path.samefile(named.group(1), str(venv))):  # noqa: PTH110, PTH121
        return f"it was made in {named.group(1)}"
    return ""


def version_of(python: Path) -> "tuple | None":
    """Return the version of a Python as (major, minor), or None where it does not run."""
    code = "import sys; print(*sys.version_info[:2])"
    try:
        answer = subprocess.run([str(python), "-c", code], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        return tuple(map(int, answer.stdout.split())) or None
    except (OSError, ValueError):
        return None


def require(version: tuple, python: str) -> None:
    """Check that a Python is new enough."""
    if version < NEEDED:
        raise InstallError(
            f"Python {dotted(NEEDED)} or newer is needed, and {python} is {dotted(version)}; name another one, as in "
            f"make install PYTHON=python{dotted(NEEDED)}"
        )


def fetch(root: Path, venv: Path) -> None:
    """Install the pinned packages and the checkout itself, by uv, or by pip where uv cannot be had."""
    python, pins = str(venv / "bin" / "python"), "constraints.txt"
    pip = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--retries", "1"]
    try:
        run([*pip, "--constraint", pins, "uv"], root)
    except InstallError as failure:
        if "network" in str(failure):
            raise
        run([*pip, "--constraint", pins, "--editable", ".[dev]"], root)
        return
    uv = [str(venv / "bin" / "uv"), "pip", "install", "--quiet", "--python", python]
    run([*uv, "--constraint", pins, "--build-constraint", pins, "--editable", ".[dev]"], root)


def run(command: list, root: Path) -> None:
    """Run a command in the checkout; what it prints is shown where it fails."""
    pins = {"PIP_CONSTRAINT": "constraints.txt", "PIP_BUILD_CONSTRAINT": "constraints.txt"}  # of what pip builds with
    ended = subprocess.run(
        command, cwd=str(root), env={**os.environ, **pins}, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
    )
    if ended.returncode:
        printed = ended.stdout.decode(errors="replace")
        print(printed.rstrip(), file=sys.stderr)
        raise InstallError(explain(printed, command))


def explain(printed: str, command: list) -> str:
    """Return what to do where a command failed, from what it printed."""
    if _NO_NETWORK.search(printed):
        return "the packages cannot be fetched: is there a network? What is there stays; run it again when there is one"
    return f"{' '.join(command[:4])} failed, see above"


def digest(root: Path) -> str:
    """Return a digest of what .venv is made by."""
    files = [(root / name).read_bytes() for name in ("pyproject.toml", "constraints.txt")]
    return hashlib.sha256(b"\0".join(files)).hexdigest()


def dotted(version: tuple) -> str:
    """Return a version as it is written."""
    return ".".join(map(str, version))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
