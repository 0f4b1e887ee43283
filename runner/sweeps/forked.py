"""Code of worker processes: a first process imports the runner once, and forks a worker for each pipe it receives."""

import contextlib
import importlib
import os
import signal
import socket
import sys
import threading
import traceback
from collections.abc import Callable, Sequence
from multiprocessing.connection import Connection
from queue import SimpleQueue
from typing import NoReturn

from runner.sweeps.work import Chunk, ChunkResult, work

_closing = threading.Event()  # the worker shall start no further run
_LOOK_EVERY = 0.02  # s, while a worker that shall end is at its last run


def fork_workers(control: int, modules: Sequence[str]) -> NoReturn:
    """Fork a worker for each pipe that arrives on a socket, until the command closes it; end after the workers.

    The process has one thread, so a fork is a whole copy.

    Args:
        control: File descriptor of the socket.
        modules: Modules to import first.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the command ends its workers
    for name in modules:
        importlib.import_module(name)
    with socket.socket(fileno=control) as pipes:
        while (received := socket.recv_fds(pipes, 1, 1))[0]:
            (pipe,) = received[1]
            if os.fork() == 0:
                pipes.close()
                _work_through(pipe)
            os.close(pipe)
            with contextlib.suppress(ChildProcessError):
                while os.waitpid(-1, os.WNOHANG)[0]:
                    pass
    with contextlib.suppress(ChildProcessError):
        while True:
            os.wait()
    os._exit(0)  # without the libraries' own ends, which take half a second


def _work_through(pipe: int) -> None:
    """Be a worker, and end its process."""
    code = 1
    try:
        _work(Connection(pipe))
        code = 0
    except Exception:
        traceback.print_exc()
    finally:
        for stream in (sys.stdout, sys.stderr):
            with contextlib.suppress(AttributeError, OSError, ValueError):  # it may be closed
                stream.flush()
        os._exit(code)


def _work(pipe: "Connection[object, Chunk | None]") -> None:
    """Execute the chunks that arrive through a pipe, in a thread, until None arrives.

    It sends its process ID, numbers of finished ticks as (chunk, ticks), and the result of each chunk, or the traceback
    of an internal error. If the pipe ends, the command is gone, and the process ends at once.
    """
    chunks: SimpleQueue[Chunk | None] = SimpleQueue()
    sending = threading.Lock()

    def send(message: object) -> None:
        with sending, contextlib.suppress(OSError):
            pipe.send(message)

    def execute() -> None:
        while (chunk := chunks.get()) is not None:
            send(_result(chunk, send))

    send(os.getpid())
    thread = threading.Thread(target=execute)
    thread.start()
    try:
        while (chunk := pipe.recv()) is not None:
            chunks.put(chunk)
        _closing.set()
        chunks.put(None)
        while thread.is_alive():
            if pipe.poll(_LOOK_EVERY):
                pipe.recv()
    except (EOFError, OSError):
        os._exit(1)


def _result(chunk: Chunk, send: Callable[[object], None]) -> ChunkResult | str:
    try:
        return work(chunk, lambda ticks: send((chunk.name, ticks)), lambda: not _closing.is_set())
    except OSError as error:
        return ChunkResult([], f"a worker failed: {error}", 0.0)
    except Exception:
        return traceback.format_exc()
