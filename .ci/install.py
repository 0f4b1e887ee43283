"""Make .venv, or fix it: `make install` runs this, with the Python that .venv is to have where one was asked for.

Else it looks for a Python 3.11, for which there are wheels of PyBullet, and next for the newest that is supported. It
runs itself on any Python 3.6 or newer, to say which are supported. A .venv that is sound stays; one whose Python is
gone or too old, or that was moved (its scripts name the folder that they were made in), is made again.
"""

import hashlib
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SUPPORTED = ((3, 11), (3, 14), (3, 13), (3, 12))  # in the order in which one is looked for
WHEELS_OF_PYBULLET = (3, 11)  # up to this version
HASHED = ("--require-hashes", "--no-build-isolation", "--requirement")
_NO_NETWORK = re.compile(
    "name resolution|Name or service not known|establish a new connection|dns error|error sending request|client error|"
    "Network is unreachable|Connection refused|timed out|Could not fetch URL|Failed to fetch"
)


class InstallError(Exception):
    """Reason why .venv cannot be made, with the remedy, in a line."""


def main(arguments: list) -> int:
    """Make .venv fit; return the exit code.

    Args:
        arguments: "--any-version" lets a sound .venv stay whatever its Python, and chooses the one of a new .venv; else
            it has the version of this one.
    """
    try:
        install(ROOT, "--any-version" in arguments)
    except InstallError as failure:
        print(f"make install: {failure}", file=sys.stderr)
        return 2
    return 0


def install(root: Path, any_version: bool) -> None:
    """Make or fix the .venv of a checkout; see main."""
    venv, stamp = root / ".venv", root / ".venv" / ".installed"
    reason = why_anew(venv, any_version)
    if not reason and stamp.is_file() and stamp.read_text() == digest(root):
        return
    python = sys.executable
    if reason or not venv.exists():
        version, python = choose() if any_version else (sys.version_info[:2], sys.executable)
        require(version, python)
        if reason:
            print(f"make install: .venv is made anew: {reason}", file=sys.stderr)
        print(f"make install: {describe(version, python, any_version)}", file=sys.stderr)
    if reason:
        shutil.rmtree(str(venv))
    if not (venv / "bin" / "pip").exists():
        run([python if not venv.exists() else str(venv / "bin" / "python"), "-m", "venv", str(venv)], root)
    fetch(root, venv)
    stamp.write_text(digest(root))


def why_anew(venv: Path, any_version: bool) -> str:
    """Return why a .venv cannot stay; empty where it can, or there is none."""
    if not venv.exists():
        return ""
    found = version_of(venv / "bin" / "python")
    if found is None:
        return "its Python is gone"
    if found < min(SUPPORTED) or not (any_version or found == sys.version_info[:2]):
        return f"it has Python {dotted(found)}"
    pip = venv / "bin" / "pip"
    named = re.search(r"(/.*?)/bin/python", pip.read_text(errors="replace")) if pip.is_file() else None
    if named and not (os.path.exists(named.group(1)) and os.path.samefile(named.group(1), str(venv))):  # noqa: PTH110, PTH121
        return f"it was made in {named.group(1)}"
    return ""


def choose() -> tuple:
    """Return version and path of the Python for a new .venv: the first supported that is found, else this one."""
    for version in SUPPORTED:
        for python in candidates(version):
            if version_of(python, "ensurepip, sys, venv") == version:
                return version, str(python)
    return sys.version_info[:2], sys.executable


def candidates(version: tuple) -> list:
    """Return the places of a version: this Python, those on the PATH, and pyenv's, newest first."""
    name = "python" + dotted(version)
    on_path = [Path(folder) / name for folder in os.environ.get("PATH", "").split(os.pathsep) if folder]
    pyenv = Path(os.environ.get("PYENV_ROOT") or os.path.expanduser("~/.pyenv")) / "versions"  # noqa: PTH111
    found = pyenv.glob(dotted(version) + ".*/bin/" + name) if os.access(str(pyenv), os.R_OK | os.X_OK) else ()
    kept = sorted(found, key=lambda path: patch(path.parts[-3]), reverse=True)
    running = [Path(sys.executable)] if sys.version_info[:2] == version else []
    return [*running, *(path for path in on_path if path.is_file()), *kept]


def patch(version: str) -> int:
    """Return the last number of a version such as 3.11.7."""
    digits = re.match(r"\d+", version.rpartition(".")[2])
    return int(digits.group()) if digits else -1


def describe(version: tuple, python: str, chosen: bool) -> str:
    """Return the Python of a .venv with the reason; `chosen` is True if nobody asked for it."""
    why = ", as asked for"
    if chosen:
        why = "" if version == SUPPORTED[0] else f", as no Python {dotted(SUPPORTED[0])} was found"
    if version <= WHEELS_OF_PYBULLET:
        what = "PyBullet has a wheel for it"
    else:
        what = "PyBullet has no wheel for it and is left out; plant=bullet is compiled"
    return f"Python {dotted(version)} ({python}){why}: {what}"


def version_of(python: Path, modules: str = "sys") -> "tuple | None":
    """Return the version of a Python as (major, minor), or None where it does not run or lacks a module."""
    code = f"import {modules}; print(*sys.version_info[:2])"
    try:
        answer = subprocess.run([str(python), "-c", code], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        return tuple(map(int, answer.stdout.split())) or None
    except (OSError, ValueError):
        return None


def require(version: tuple, python: str) -> None:
    """Check that a Python is supported."""
    oldest, newest = min(SUPPORTED), max(SUPPORTED)
    if not oldest <= version <= newest:
        why = ", for which pin (Pinocchio) has no wheel" if version > newest else ""
        raise InstallError(
            f"Python {dotted(oldest)} to {dotted(newest)} is needed, and {python} is {dotted(version)}{why}; name "
            f"another one, as in make install PYTHON=python{dotted(oldest)}"
        )


def fetch(root: Path, venv: Path) -> None:
    """Install the pinned packages and then the checkout itself, by uv, or by pip where uv cannot be had.

    Every file that is fetched must have a digest that constraints.txt lists. What comes as source, and the checkout, is
    built by packages that were installed before. Where Python does not write bytecode, it is written here: else
    each process would compile every module that it imports.
    """
    python = str(venv / "bin" / "python")
    install = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--retries", "1"]
    run([*install, *HASHED, pinned(root, venv, "setuptools")], root)
    try:
        run([*install, *HASHED, pinned(root, venv, "uv")], root)
    except InstallError as failure:
        if "network" in str(failure):
            raise
    else:
        install = [str(venv / "bin" / "uv"), "pip", "install", "--quiet", "--system-certs", "--python", python]
        install += [] if can_cache() else ["--no-cache"]
        install += ["--compile-bytecode"] if os.environ.get("PYTHONDONTWRITEBYTECODE") else []
    run([*install, *HASHED, "constraints.txt"], root)
    run([*install, "--no-deps", "--no-build-isolation", "--editable", "."], root)
    if os.environ.get("PYTHONDONTWRITEBYTECODE"):
        run([python, "-m", "compileall", "-q", "runner", "hydra_plugins"], root)


def pinned(root: Path, venv: Path, name: str) -> str:
    """Return a file in .venv with the pin of one package, as pip takes digests from only files."""
    found = re.search("^" + name + r"==(.*\\\n)*.*\n", (root / "constraints.txt").read_text(), re.M)
    if found is None:
        raise InstallError(f"constraints.txt pins no {name}; `make pins` writes it anew")
    file = venv / (name + ".txt")
    file.write_text(found.group())
    return str(file)


def can_cache() -> bool:
    """Return True if uv can write the folder in which it keeps what it fetched; it is often below the home."""
    base = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")  # noqa: PTH111
    place = Path(os.environ.get("UV_CACHE_DIR") or os.path.join(base, "uv"))  # noqa: PTH118
    existing = next(path for path in (place, *place.absolute().parents) if path.exists())
    return os.access(str(existing), os.W_OK)


def run(command: list, root: Path) -> None:
    """Run a command in the checkout; what it prints is shown where it fails."""
    ended = subprocess.run(command, cwd=str(root), stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if ended.returncode:
        printed = ended.stdout.decode(errors="replace")
        print(printed.rstrip(), file=sys.stderr)
        raise InstallError(explain(printed, command))


def explain(printed: str, command: list) -> str:
    """Return the remedy of a failed command, from its output."""
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
