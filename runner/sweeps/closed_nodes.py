"""Dask scheduler and worker without an HTTP server, whatever the settings."""

from typing import Any

from distributed import Scheduler, Worker


def _open_nothing(*_: Any, **__: Any) -> None:
    """Stand in for `start_http_server`."""


class ClosedScheduler(Scheduler):  # type: ignore[misc] # Dask's types are partial
    """A scheduler that answers no HTTP."""

    start_http_server = _open_nothing


class ClosedWorker(Worker):  # type: ignore[misc]
    """A worker that answers no HTTP."""

    start_http_server = _open_nothing
