"""Error in a chapter, with file and line."""

from runner.base.errors import RunnerError


class ProseError(RunnerError):
    """A chapter that cannot be read.

    Args:
        file: Its name.
        line: The line, counted from 1.
        text: What is wrong, and what to write in its place.
    """

    def __init__(self, file: str, line: int, text: str) -> None:
        super().__init__(f"{file}:{line}: {text}")
        self.line = line
