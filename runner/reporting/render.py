"""Output files of a report: one offline HTML file and one PDF."""

from collections.abc import Callable, Collection
from pathlib import Path

from runner.base.errors import RunnerError
from runner.reporting import html, pdf
from runner.reporting.consistency import make_consistent
from runner.reporting.document import Document
from runner.store.atomic import write_atomically

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
        RunnerError: If a format is unknown, or the disk does not take a file.
    """
    unknown = sorted(set(formats) - set(_RENDERERS))
    if unknown:
        raise RunnerError(f"unknown report format {', '.join(unknown)}; allowed: {', '.join(_RENDERERS)}")
    folder.mkdir(parents=True, exist_ok=True)
    shown = make_consistent(document)
    written = [folder / f"report.{name}" for name in formats]
    for name, path in zip(formats, written, strict=True):
        write_atomically(path, _RENDERERS[name](shown))
    return written
