"""Report as PDF, compiled by Typst in a folder with only the files of the report."""

import tempfile
from datetime import UTC, datetime
from pathlib import Path

import typst

from runner.base import progress
from runner.reporting import formulas, outline
from runner.reporting.charts import static
from runner.reporting.document import Curves, Document, Maps
from runner.reporting.outline import Places
from runner.reporting.run_list import first_runs
from runner.reporting.templating import typst_environment
from runner.reporting.verdicts import tallies


def render(document: Document) -> bytes:
    """Return a document as PDF; the same document gives the same bytes."""
    progress.begin("drawing figures", outline.count_figures(document), "figures")
    made = formulas.all_mathml(document)
    with tempfile.TemporaryDirectory() as name:
        folder = _Folder(Path(name))
        source = (
            typst_environment()
            .get_template("report.typ.j2")
            .render(
                document=document,
                chapters=outline.chapters(document),
                formula_valid=lambda text, is_displayed: made[is_displayed].get(text) is not None,
                figure_file=folder.figure,
                first_runs=first_runs,
                image_file=folder.image,
                places=Places(document),
                tallies=tallies(document),
            )
        )
        path = folder.root / "report.typ"
        path.write_text(source, encoding="utf-8")
        progress.begin("writing the PDF")
        return typst.compile(
            path, root=folder.root, format="pdf", ignore_system_fonts=True, timestamp=_timestamp(document.date)
        )


class _Folder:
    """The images of one report, as files next to it."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self._count = 0

    def figure(self, block: Curves | Maps) -> str:
        progress.step()
        return self.image(static.draw(block))

    def image(self, svg: str) -> str:
        self._count += 1
        name = f"image-{self._count}.svg"
        (self.root / name).write_text(svg, encoding="utf-8", errors="replace")
        return name


def _timestamp(date: str) -> int:
    """Return a date in seconds since 1970; the epoch itself where it is none, so that no clock enters the report."""
    try:
        moment = datetime.fromisoformat(date)
    except ValueError:
        return 0
    return int((moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp())
