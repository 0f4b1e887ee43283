"""Workers of a running Dask scheduler: its address, the check of its workers, and those that a command leaves out."""

import contextlib
import logging
import os
import re
import socket
import sys
import time
import warnings
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from runner.assembly.versions import versions
from runner.base import progress
from runner.base.bounded_json import decode_json
from runner.base.errors import ConfigError, RunnerError, TemporaryError
from runner.base.limits import RECORD, read_text
from runner.base.sanitize import few, one_line, quoted
from runner.store.physics import physics_digest

_ADDRESS = re.compile(r"(\w+://)?[^\s/]+:\d+")
_FILE = ".json"
_ANSWER_WITHIN = 10.0  # s, for a scheduler, and for the workers of one that is given by its address
_BEGIN_WITHIN = 60.0  # s, for a scheduler file and for the first worker: a job starts both with the command
_LOOK_EVERY = 0.2  # s, for a scheduler file
_SAME = "install the same version of the runner for the command, the scheduler and all workers"
GO_ON = "finished runs are stored; the same command continues"


class Remote:
    """Workers of a running scheduler, without those that cannot make runs of this command.

    Such a worker stays at work for other commands of the scheduler.

    Args:
        client: A `distributed.Client`.

    Attributes:
        client: The client.
    """

    def __init__(self, client: Any) -> None:
        self.client = client
        self._left_out: set[str] = set()

    def usable(self) -> list[str]:
        """Return the addresses of the workers, without those left out."""
        return [address for address in self.client.nthreads() if address not in self._left_out]

    def only(self) -> list[str] | None:
        """Return the workers to which a task is restricted; None if none is left out."""
        return self.usable() if self._left_out else None

    def leave_out(self, address: str, reason: str) -> None:
        """Leave out a worker from now on, and print the reason once."""
        if address not in self._left_out:
            self._left_out.add(address)
            _warn(f"{reason}; this sweep goes on without this worker")


def check_address(text: object) -> None:
    """Check that a value is the address of a scheduler, or the name of a scheduler file.

    Raises:
        ConfigError: if it is neither.
    """
    if not isinstance(text, str) or not (_ADDRESS.fullmatch(text) or text.endswith(_FILE)):
        raise ConfigError(
            "hydra.sweeper.address: must be the address of a Dask scheduler, such as tcp://10.0.0.1:8786, or its "
            f"scheduler file, such as scheduler.json; found {quoted(text)}"
        )


@contextlib.contextmanager
def remote_workers(given: str) -> Iterator[Remote]:
    """Connect to a running Dask scheduler; yield its workers.

    Args:
        given: Address of the scheduler, or its scheduler file; see check_address.

    Raises:
        RunnerError: if no scheduler answers, or it or all workers have another version of the runner.
        TemporaryError: if the scheduler file or the first worker does not appear in time.
    """
    from distributed import Client
    from distributed.versions import VersionMismatchWarning

    file = given if given.endswith(_FILE) else ""
    address, within = (_read_address(Path(file).expanduser()), _BEGIN_WITHIN) if file else (given, _ANSWER_WITHIN)
    start = _how_to_start(file, address)
    hush()
    try:
        with warnings.catch_warnings():  # _check_workers says it
            warnings.simplefilter("ignore", VersionMismatchWarning)
            client = Client(address, timeout=_ANSWER_WITHIN)
    except (OSError, TimeoutError, ValueError) as error:
        stale = f", which {file} names; remove the file, and" if file else ";"
        raise RunnerError(f"hydra.sweeper.address: no Dask scheduler answers at {address}{stale} {start}") from error
    with client:
        try:
            client.wait_for_workers(1, timeout=within)
        except TimeoutError as error:
            raise TemporaryError(
                f"hydra.sweeper.address: the scheduler at {address} has no workers after {within:g} s; {start}"
            ) from error
        remote = Remote(client)
        _check_workers(remote)
        yield remote


def _how_to_start(file: str, address: str) -> str:
    where = f"--scheduler-file {file}" if file else f"--port {address.rpartition(':')[2]}"
    to = f"--scheduler-file {file}" if file else address
    workers = f"`dask worker {to} --nthreads 1 --nworkers {os.cpu_count()}`"
    return f"start one with `dask scheduler --host 127.0.0.1 {where}` and workers with {workers}"


def _read_address(file: Path) -> str:
    """Return the address in a scheduler file, which the scheduler may still have to write."""
    progress.begin("waiting for the scheduler")
    end = time.monotonic() + _BEGIN_WITHIN
    while True:
        found = None
        with contextlib.suppress(OSError, ValueError, LookupError, TypeError):
            found = decode_json(read_text(file, RECORD))["address"]
        if isinstance(found, str) and _ADDRESS.fullmatch(found):
            return found
        if time.monotonic() > end:
            break
        time.sleep(_LOOK_EVERY)
    if file.exists():
        raise RunnerError(
            f"hydra.sweeper.address: {file} is not a scheduler file of Dask; {_how_to_start(str(file), '')}"
        )
    raise TemporaryError(
        f"hydra.sweeper.address: no scheduler has written {file} within {_BEGIN_WITHIN:g} s; "
        f"{_how_to_start(str(file), '')}"
    )


def _check_workers(remote: Remote) -> None:
    """Leave out workers with other source code, and warn of those with other libraries.

    Raises:
        RunnerError: if no worker remains, or the scheduler has other source code.
    """
    try:
        _, digest, _ = remote.client.run_on_scheduler(_describe)
    except (ImportError, AttributeError) as error:
        raise RunnerError(f"the cluster cannot execute runs: {error}; {_SAME}") from error
    if digest != physics_digest():
        raise RunnerError(f"the scheduler has other source code than the command; {_SAME}")
    found = remote.client.run(_describe, on_error="return")
    other: dict[str, list[str]] = {}
    reason = ""
    for address, answer in found.items():
        if isinstance(answer, BaseException):
            reason = f"{in_place('a worker cannot execute runs', '', address)}: {answer}"
        elif answer[1] != physics_digest():
            reason = in_place("a worker has other source code than the command", answer[0], address)
        else:
            if difference := _difference(answer[2]):
                other.setdefault(difference, []).append(f"{answer[0]}, {address}")
            continue
        remote.leave_out(address, reason)
    if found and not remote.usable():
        raise RunnerError(f"{reason}, and no worker is left; {_SAME}")
    for difference, places in other.items():
        where = few(places, separator="; ")
        _warn(f"results may differ in the last digits, because workers have {difference} ({where})")


def _describe() -> tuple[str, str, Mapping[str, str]]:
    """Return the host of this process, the digest of its source code and its versions of libraries."""
    return socket.gethostname(), physics_digest(), versions()


def _difference(theirs: Mapping[str, str]) -> str:
    ours = versions()
    names: Sequence[str] = [name for name in {**ours, **theirs} if ours.get(name) != theirs.get(name)]
    return few([f"{name} {theirs.get(name, '(none)')} instead of {ours.get(name, '(none)')}" for name in names])


def _warn(text: str) -> None:
    print(one_line(f"runner: warning: {text}"), file=sys.stderr)


def in_place(trouble: str, host: str, address: str) -> str:
    """Return a message about a worker with its host and address."""
    return f"{trouble} ({', '.join(filter(None, (host, address)))})"


def hush() -> None:
    """Silence Dask's log; the runner reports the relevant events as failures of runs or errors."""
    for part in ("", ".client", ".core", ".nanny", ".scheduler", ".worker"):
        logging.getLogger(f"distributed{part}").setLevel(logging.CRITICAL)
