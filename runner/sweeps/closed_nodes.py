"""Dask scheduler and worker without an HTTP server, whatever the settings."""

from typing import Any

from distributed import Scheduler, Worker


def _open_nothing(*_: Any, **__: Any) -> None:
    """Replace `start_http_server`; start nothing."""


class ClosedScheduler(Scheduler):  # type: ignore[misc] # Dask's types are partial
    """Scheduler without an HTTP server."""

    start_http_server = _open_nothing


class ClosedWorker(Worker):  # type: ignore[misc]
    """Worker without an HTTP server."""

    start_http_server = _open_nothing
