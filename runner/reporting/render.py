"""A report written to its folder: one offline HTML file and one PDF."""

import os
import tempfile
from collections.abc import Callable, Collection
from pathlib import Path

from runner import progress
from runner.errors import RunnerError
from runner.progress.stages import of_report
from runner.reporting import html, outline, pdf
from runner.reporting.column_units import in_readable_units
from runner.reporting.document import Document

_RENDERERS: dict[str, Callable[[Document], bytes]] = {
    "html": lambda document: html.render(document).encode("utf-8", errors="replace"),
    "pdf": pdf.render,
}


def write_report(document: Document, folder: Path, formats: Collection[str] = ("html", "pdf")) -> list[Path]:
    """Render a document and write `report.html` and `report.pdf`, each complete or not at all.

    Args:
        document: The report.
        folder: Where to write; made when missing.
        formats: What to write: "html", "pdf" or both.

    Returns:
        The files written, in the order of `formats`.

    Raises:
        RunnerError: If a format is unknown.
    """
    unknown = sorted(set(formats) - set(_RENDERERS))
    if unknown:
        raise RunnerError(f"unknown report format {', '.join(unknown)}; allowed: {', '.join(_RENDERERS)}")
    folder.mkdir(parents=True, exist_ok=True)
    progress.plan(of_report(formats, outline.count_figures(document)))
    shown = in_readable_units(document)
    return [_write(folder / f"report.{name}", _RENDERERS[name](shown)) for name in formats]


def _write(path: Path, content: bytes) -> Path:
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    temporary = Path(name)
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        # mkstemp makes files for their owner alone; a report is to be passed on.
        temporary.chmod(0o644)
        temporary.replace(path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
    return path
