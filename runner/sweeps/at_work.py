"""Commands at work on a sweep or tuning: each has a locked file in its folder, with its host, job and last sign.

Several commands may work on one sweep. File systems of clusters may lock a file on one machine only, and report
success. So a command of another machine is also at work if its last sign, the change time of its file, is young.
"""

import contextlib
import fcntl
import os
import secrets
import socket
import threading
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from runner.base.errors import StoreError, TemporaryError, describe_write_error
from runner.base.quantities import format_duration
from runner.base.sanitize import few, one_line
from runner.store.kinds import KINDS

_START, _EXCLUSIVE = "at_work-", "exclusive"
_EVERY = 2.0  # s between two signs
_YOUNG = 120.0  # s; a network file system shows the sign of another machine up to a minute late
_PATIENCE = 1.0  # s; `runner status` holds a lock for an instant


@dataclass(frozen=True)
class Command:
    """A command at work.

    Attributes:
        name: Random part of the names of its files; see at_work.
        host: Name of its machine.
        job: Its job of Slurm, or its process.
        age: Time since its last sign, in s.
    """

    name: str
    host: str
    job: str
    age: float

    def __str__(self) -> str:
        return one_line(f"{self.host}, {self.job}, last sign {format_duration(self.age)} ago")


@contextlib.contextmanager
def at_work(folder: Path, exclusive: bool = False) -> Iterator[str]:
    """Record that this command works on a sweep or tuning; the record ends with the process, even if that is killed.

    Args:
        folder: Folder of the sweep or tuning.
        exclusive: True if no other command may work on it.

    Yields:
        A random name of the command, for the names of its files.

    Raises:
        TemporaryError: if `exclusive`, and another command works on it.
        StoreError: if the file cannot be written.
    """
    name = secrets.token_hex(4)
    path = folder / f"{_START}{_EXCLUSIVE if exclusive else name}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        _remove_dead(folder)
        file = _lock(path)
    except OSError as error:
        raise StoreError(describe_write_error(error, path)) from error
    ended = threading.Event()
    signs = threading.Thread(target=_give_signs, args=(file, ended), daemon=True)
    try:
        os.write(file, f"{socket.gethostname()}\n{_job()}\n".encode())
        signs.start()
        yield name
    finally:
        ended.set()
        if signs.ident is not None:
            signs.join()
        path.unlink(missing_ok=True)
        os.close(file)


def commands_at_work(folder: Path) -> Sequence[Command]:
    """Return the commands that work on a sweep or tuning, given by its folder."""
    return _at_work(folder.glob(f"{_START}*"))


def commands_in(outputs: Path) -> Sequence[Command]:
    """Return the commands that work on any sweep or tuning of an outputs folder."""
    kinds = (KINDS["sweep"], KINDS["tuning"])
    return _at_work(path for kind in kinds for path in outputs.glob(f"{kind.folder}/*/{_START}*"))


def in_words(commands: Sequence[Command]) -> str:
    """Return commands as a message, such as "n1, job 16, last sign 3 s ago"."""
    return few([str(command) for command in commands], separator="; ")


def _at_work(paths: Iterator[Path]) -> list[Command]:
    return [command for path in sorted(paths) if (command := _look(path)) is not None]


def _look(path: Path) -> Command | None:
    """Return the command of a file; None if it has ended."""
    try:
        with path.open("rb+") as file:  # NFS locks only files that are open to write
            held = not _try(file.fileno(), fcntl.LOCK_SH)
            lines = file.read(1000).decode(errors="replace").split("\n")
            age = max(0.0, time.time() - os.fstat(file.fileno()).st_mtime)
    except OSError:
        return None
    host, job = lines[:2] if len(lines) > 2 else ("a machine", "a command that starts")
    if held or (host != socket.gethostname() and age < _YOUNG):
        return Command(path.name.removeprefix(_START), host, job, age)
    return None


def _lock(path: Path) -> int:
    """Return a locked file, created if it is missing.

    Raises:
        TemporaryError: if the command is to be exclusive, and another one is at work.
    """
    deadline = time.monotonic() + _PATIENCE
    while True:
        others = commands_at_work(path.parent) if path.name == _START + _EXCLUSIVE else ()
        file = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        if not others and _try(file, fcntl.LOCK_EX) and os.fstat(file).st_nlink:
            os.ftruncate(file, 0)
            return file
        os.close(file)
        if time.monotonic() > deadline:
            raise TemporaryError(
                f"another command is at work on {path.parent} ({in_words(others)}); wait for it, or choose another "
                "folder with outputs=FOLDER"
            )
        time.sleep(0.05)


def _try(file: int, lock: int) -> bool:
    """Return True if a file is locked now, or if its file system has no locks."""
    try:
        fcntl.flock(file, lock | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return True
    return True


def _give_signs(file: int, ended: threading.Event) -> None:
    while not ended.wait(_EVERY):
        with contextlib.suppress(OSError):
            os.utime(file)


def _remove_dead(folder: Path) -> None:
    for path in folder.glob(f"{_START}*"):
        if _look(path) is None:
            path.unlink(missing_ok=True)


def _job() -> str:
    """Return the job of Slurm that this process belongs to, as `squeue` shows it, or the process."""
    array, task = os.environ.get("SLURM_ARRAY_JOB_ID"), os.environ.get("SLURM_ARRAY_TASK_ID")
    job = f"{array}_{task}" if array and task else os.environ.get("SLURM_JOB_ID")
    return f"job {job}" if job else f"process {os.getpid()}"
