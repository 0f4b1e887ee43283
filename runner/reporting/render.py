"""Output files of a report: a self-contained HTML file that needs no network, and a PDF compiled by Typst."""

import base64
import gzip
import hashlib
import json
import tempfile
from collections.abc import Callable, Collection, Sequence
from datetime import UTC, datetime
from functools import cache, lru_cache
from importlib import resources
from itertools import count
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np
import typst

from runner.base import progress
from runner.base.atomic import write_atomically
from runner.base.errors import RunnerError
from runner.base.paths import templates_dir
from runner.base.quantities import number, unit_text
from runner.base.sanitize import plain
from runner.reporting import mathml, outline
from runner.reporting.charts import palette, static
from runner.reporting.charts.interactive import pack, plotly_spec
from runner.reporting.consistency import make_consistent
from runner.reporting.document import Curves, Document, Maps, Playback, RunList
from runner.reporting.metric_titles import metric_label
from runner.reporting.outline import Places
from runner.reporting.playback import playback_spec
from runner.reporting.table import Table, numbers
from runner.reporting.templating import CodeText, html_environment, typst_environment

SHOWN = 6
"""Metrics in the table; the details of a run have all of them."""
ON_PAPER_METRICS = 3
"""Metrics of the table on paper, whose heads must not run into each other."""
ON_PAPER = 20
"""Runs that are listed where nothing can be filtered."""
_OF_PLOTS = ("plot_keys", "curves")
_SCRIPTS = ("report", *_OF_PLOTS, "motion", "figure_tools")


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
    drawn = _Drawings()  # both formats show the first figure
    renderers = {
        "html": lambda shown: render_html(shown, drawn).encode("utf-8", errors="replace"),
        "pdf": lambda shown: render_pdf(shown, drawn),
    }
    unknown = sorted(set(formats) - set(renderers))
    if unknown:
        raise RunnerError(f"unknown report format {', '.join(unknown)}; allowed: {', '.join(renderers)}")
    folder.mkdir(parents=True, exist_ok=True)
    shown = make_consistent(document)
    written = [folder / f"report.{name}" for name in formats]
    for name, path in zip(formats, written, strict=True):
        write_atomically(path, renderers[name](shown))
    return written


def _content(document: Document) -> dict[str, Any]:
    """Return the values that both templates show of a document."""
    shown = {"chapters": outline.chapters(document), "places": Places(document), "tallies": outline.tallies(document)}
    return {"document": document, **shown}


class _Drawings:
    """Figures as SVG; the one drawn last is kept."""

    def __init__(self) -> None:
        self._last: tuple[Curves | Maps, str] | None = None

    def __call__(self, figure: Curves | Maps) -> str:
        if self._last is None or self._last[0] is not figure:
            self._last = figure, static.draw(figure)
        return self._last[1]


def render_html(document: Document, draw: Callable[[Curves | Maps], str] = static.draw) -> str:
    """Return a document as an HTML page.

    Args:
        document: The report.
        draw: Returns a figure as SVG.
    """
    progress.begin("writing the HTML")
    made = mathml.all_mathml(document)
    has_plots, has_run_list, has_playback = (
        any(isinstance(block, kinds) for block in outline.blocks(document))
        for kinds in ((Curves, Maps, RunList), RunList, Playback)
    )
    library = _plotly() if has_plots else ""
    first = next((block for block in outline.blocks(document) if isinstance(block, Curves | Maps)), None)
    left_out = (() if has_plots else _OF_PLOTS) + (() if has_plots or has_playback else ("motion",))
    return (
        html_environment()
        .get_template("report.html.j2")
        .render(
            **_content(document),
            mathml=lambda text, is_displayed: made[is_displayed].get(text.strip()),
            math_font=_math_font() if any(made.values()) else "",
            plotly_spec=plotly_spec,
            run_list_spec=run_list_spec,
            data_uri=data_uri,
            first_still=lambda block: draw(first) if first is not None and block is first else "",
            plots=_Pack(),
            pictures=_Pack(),
            playback_spec=playback_spec,
            plotly=compress_text(library) if library else "",
            script_sources=lambda own: script_policy([*own, *([library] if library else [])]),
            palette={"light": palette.LIGHT, "dark": palette.DARK},
            style=asset("style.css"),
            scripts=[asset(f"{name}.js") for name in _SCRIPTS if name not in left_out],
            run_list_script=asset("run_list.js") if has_run_list else "",
        )
    )


def data_uri(svg: str) -> str:
    """Return an SVG as the address of an image; images share no ids and run no scripts."""
    return "data:image/svg+xml," + quote(svg, safe=" /:=;()+*!@?", encoding="utf-8", errors="replace")


class _Pack(list[object]):
    """Data of plots, or pictures, which the page's script unpacks; figures name them by their places."""

    def put(self, item: object) -> int:
        """Take an item, and return its place."""
        self.append(item)
        return len(self) - 1

    def packed(self) -> str:
        """Return all items as the page holds them."""
        return compress_text(json.dumps(self, separators=(",", ":"))) if self else ""


@lru_cache(maxsize=16)
def compress_text(text: str) -> str:
    """Return a string as base64 of its gzip, the same each time; `inflate` in report.js undoes it."""
    return base64.b64encode(gzip.compress(text.encode("utf-8"), compresslevel=9, mtime=0)).decode("ascii")


@cache
def _plotly() -> str:
    return resources.files("plotly").joinpath("package_data", "plotly.min.js").read_text(encoding="utf-8")


@cache
def _math_font() -> str:
    return base64.b64encode((templates_dir() / "maths.woff2").read_bytes()).decode("ascii")


def script_policy(scripts: Sequence[str]) -> CodeText:
    """Return the sources of some scripts in a policy."""
    return CodeText(" ".join(f"'sha256-{_sha256(script)}'" for script in scripts))


def _sha256(text: str) -> str:
    return base64.b64encode(hashlib.sha256(text.encode()).digest()).decode("ascii")


def asset(name: str) -> CodeText:
    """Return a style or a script of the templates."""
    return CodeText((templates_dir() / name).read_text(encoding="utf-8"))


def render_pdf(document: Document, draw: Callable[[Curves | Maps], str] = static.draw) -> bytes:
    """Return a document as PDF; the same document gives the same bytes.

    Args:
        document: The report.
        draw: Returns a figure as SVG.
    """
    progress.begin("drawing figures", outline.count_figures(document), "figures")
    made = mathml.all_mathml(document)
    with tempfile.TemporaryDirectory() as name:
        folder, numbers = Path(name), count(1)

        def image_file(svg: str) -> str:
            path = folder / f"image-{next(numbers)}.svg"
            path.write_text(svg, encoding="utf-8", errors="replace")
            return path.name

        def figure_file(block: Curves | Maps) -> str:
            progress.step()
            return image_file(draw(block))

        source = (
            typst_environment()
            .get_template("report.typ.j2")
            .render(
                **_content(document),
                formula_valid=lambda text, is_displayed: made[is_displayed].get(text) is not None,
                figure_file=figure_file,
                first_runs=first_runs,
                palette=palette.LIGHT,
                image_file=image_file,
            )
        )
        path = folder / "report.typ"
        path.write_text(source, encoding="utf-8")
        progress.begin("writing the PDF")
        return typst.compile(
            path, root=folder, format="pdf", ignore_system_fonts=True, timestamp=_timestamp(document.date)
        )


def _timestamp(date: str) -> int:
    """Return a date in seconds since 1970; the epoch itself where it is none, so that no clock enters the report."""
    try:
        moment = datetime.fromisoformat(date)
    except ValueError:
        return 0
    return int((moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp())


def run_list_spec(block: RunList) -> dict[str, Any]:
    """Return the content of the list in HTML: names, and a column of numbers for each axis and metric."""
    return {
        "axes": [{"name": plain(name), "values": [plain(value) for value in values]} for name, values in block.axes],
        "levels": [column.tolist() for column in block.levels.T],
        "metrics": [{"name": plain(name), "unit": plain(unit_text(unit))} for name, unit in block.metrics],
        "values": [pack(column) for column in block.values.T],
        "hashes": list(block.hashes),
        "failures": [plain(failure) for failure in block.failures],
        "commands": [plain(command) for command in block.commands],
        "folders": list(block.folders),
        "shown": SHOWN,
    }


def first_runs(block: RunList) -> Table:
    """Return the first rows as a table for paper."""
    rows = []
    for run in range(min(ON_PAPER, len(block.hashes))):
        levels = zip(block.axes, block.levels[run], strict=True)
        values = (None if np.isnan(value) else float(value) for value in block.values[run, :ON_PAPER_METRICS])
        cells = [block.hashes[run][:8], *(names[level] for (_, names), level in levels)]
        rows.append([*cells, "failed" if block.failures[run] else "ok", *map(number, values)])
    metrics = [metric_label(name, unit) for name, unit in block.metrics[:ON_PAPER_METRICS]]
    header = ["run", *(name for name, _ in block.axes), "status", *numbers(*metrics)]
    return Table(block.caption, header, rows, block.origin)
