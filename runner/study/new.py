"""New study from the template in examples/own_paper."""

from pathlib import Path

from runner.base.errors import RunnerError
from runner.base.paths import example_study_dir
from runner.store.atomic import write_atomically


def write_new(folder: Path) -> list[Path]:
    """Write a small study that runs at once; return its files.

    Args:
        folder: Where; made if it is not there.

    Raises:
        RunnerError: if there is something in the folder already, or it cannot be written.
    """
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise RunnerError(f"{folder}: is there already, and not empty; name a new folder")
    sources = sorted(path for path in example_study_dir().iterdir() if path.suffix in (".yaml", ".md"))
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for path in sources:
            write_atomically(folder / path.name, path.read_bytes())
    except OSError as error:
        raise RunnerError(f"{folder}: cannot be written: {error.strerror}") from error
    return [folder / path.name for path in sources]
