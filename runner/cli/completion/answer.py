"""Entry point of completion: the query of the shell, and the printed words."""

import contextlib
import io
import re
from collections.abc import Iterator, Mapping, Sequence

from runner.base.errors import RunnerError

_FLAGS = ("-sc", "--shell-completion")
_MOST = 1000  # words
# Hydra's shell functions hand the words to `compgen -W`, which expands them as the shell does: a folder's name could
# hold a command. Such words are left out; where no word is left, bash completes file names by itself.
_HARMLESS = re.compile(r"[\w@%+=:,./\[\]~-]+")


def is_asked(arguments: Sequence[str]) -> bool:
    """Tell whether a shell asks what to complete, as by `runner -sc query=bash`."""
    return any(flag in arguments for flag in _FLAGS) and any(word.startswith("query=") for word in arguments)


def answer(arguments: Sequence[str], environment: Mapping[str, str]) -> int:
    """Print the words that complete the line in COMP_LINE, and nothing else whatever happens; return the exit code.

    Raises:
        RunnerError: where no shell asks.
    """
    if "COMP_LINE" not in environment:
        raise RunnerError('the shell asks so, with COMP_LINE set; let it do so by eval "$(runner -sc install=bash)"')
    apart = "\n" if "query=fish" in arguments else " "
    found: set[str] = set()
    with _silence(), contextlib.suppress(Exception):
        from runner.cli.completion.complete import complete
        from runner.cli.completion.line import read_line

        found = {word for word in complete(read_line(environment)) if _HARMLESS.fullmatch(word)}
    print(apart.join(sorted(found)[:_MOST]))
    return 0


@contextlib.contextmanager
def _silence() -> Iterator[None]:
    """Let nothing that Python code prints through; what an engine would write itself is not loaded here."""
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        yield
