"""Figures of a report as separate files: SVG and PDF at column width, points as CSV, captions without markup."""

import itertools
import math
import re
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

import typst

from runner.base.atomic import write_atomically
from runner.base.errors import RunnerError, nearest
from runner.base.sanitize import csv_text
from runner.reporting.charts import static
from runner.reporting.charts.figure import Map, Panel, Series
from runner.reporting.charts.sheet import Sheet
from runner.reporting.consistency import make_consistent
from runner.reporting.document import Curves, Document, Maps, Picture, Playback
from runner.reporting.markup import spans
from runner.reporting.metric_titles import capital
from runner.reporting.outline import blocks, numbered_place

_WIDTH, _HEIGHT = re.compile(r'\bwidth="([\d.]+)pt"'), re.compile(r'\bheight="([\d.]+)pt"')
_POINTS, _MM = 72.0, 25.4  # in an inch
_LEAST = 7.0 / 7.5  # of a drawing, whose smallest letters are of 7.5 pt
_LONGEST = 100  # letters of a file's name
_WORD = re.compile("[a-z0-9]+")
_OF_JOINT = re.compile(r"\b(torque|force) of \S+(?= \()")
_UNIT_OF_LABEL = re.compile(r"\s*\([^()]*\)$")
Figure = Curves | Maps | Picture | Playback
Axes = TypeVar("Axes", Panel, Map)
Row = Sequence[object]


def figures_of(document: Document) -> dict[str, Figure]:
    """Return the figures of a report by name, in reading order.

    A name says what the figure shows, such as tracking-error-by-controller. It begins with the figure's number in the
    source if it has one, such as figure-3-5, and ends with -2, -3, ... if an earlier figure shows the same.
    """
    document = make_consistent(document)
    named: dict[str, Figure] = {}
    for block in blocks(document):
        if isinstance(block, Curves | Maps | Picture | Playback):
            whole = f"{numbered_place(block.origin.number, 'figure')} {_content(block)}"
            name = "-".join(_WORD.findall(whole.lower()))[:_LONGEST].strip("-") or "figure"
            several = sum(each == name or re.fullmatch(rf"{name}-\d+", each) is not None for each in named)
            named[f"{name}-{several + 1}" if several else name] = block
    return named


def _content(figure: Figure) -> str:
    """Return the content of a figure in short: the quantities of its axes, or the beginning of its caption."""
    if isinstance(figure, Playback):
        return "motion"
    if isinstance(figure, Picture):
        return plain_caption(figure.caption).partition(". ")[0]
    if isinstance(figure, Curves):
        shown, across = [panel.y_label for panel in figure.panels], [panel.x_label for panel in figure.panels]
        if len(shown) > 1:
            shown = [_OF_JOINT.sub(r"\1", label) for label in shown]
    else:
        shown = [f"map of {figure.value_label}"]
        across = [label for panel in figure.panels for label in (panel.x_label, panel.y_label)]
    what, over = _joined(shown), _joined(across)
    return f"{what} {'over' if over == 'time' else 'by'} {over}" if over else what


def _joined(labels: Sequence[str]) -> str:
    """Return the quantities of labels, each once; words with which all begin are there once, too."""
    names = [name.split() for name in dict.fromkeys(_UNIT_OF_LABEL.sub("", label) for label in labels)]
    shared = sum(1 for _ in itertools.takewhile(lambda words: len(set(words)) == 1, zip(*names, strict=False)))
    return " and ".join(filter(None, map(" ".join, [*names[:1], *(name[shared:] for name in names[1:])])))


def plain_caption(caption: str) -> str:
    """Return a caption without markup; its mathematics in Typst notation."""
    return "".join(span.text for span in spans(caption))


def for_paper(figure: Figure) -> tuple[Figure, str]:
    """Return a figure without titles, and its caption, which says what each panel shows."""
    caption = plain_caption(figure.caption).strip()
    match figure:
        case Curves():
            panels, titles = _lettered(figure.panels)
            return replace(figure, panels=panels), caption + titles
        case Maps():
            maps, titles = _lettered(figure.panels)
            return replace(figure, panels=maps), caption + titles
    return figure, caption


def _lettered(panels: Sequence[Axes]) -> tuple[list[Axes], str]:
    """Return panels with letters for titles, none if there is one panel, and what to add to the caption."""
    letters = [f"({chr(ord('a') + place % 26)})" if len(panels) > 1 else "" for place in range(len(panels))]
    titles = [f"{letter} {panel.title}".strip() for letter, panel in zip(letters, panels, strict=True) if panel.title]
    untitled = [replace(panel, title=letter) for letter, panel in zip(letters, panels, strict=True)]
    return untitled, f" {capital('; '.join(titles))}." if titles else ""


def choose_figures(figures: Mapping[str, Figure], only: str | None) -> dict[str, Figure]:
    """Return the figures that are asked for: by a whole name, or by how names begin.

    Raises:
        RunnerError: If none is; names those that there are.
    """
    if not figures:
        raise RunnerError("the report has no figures")
    found = {
        name: figure for name, figure in figures.items() if only is None or name == only or name.startswith(f"{only}-")
    }
    if not found:
        known = "\n  ".join(figures)
        raise RunnerError(f"--only: no figure '{only}'{nearest(str(only), figures)}. Allowed:\n  {known}")
    return found


def write_figures(figures: Mapping[str, Figure], folder: Path, sheet: Sheet) -> Iterator[str]:
    """Write each figure as NAME.svg and NAME.pdf, its caption as NAME.txt and its points as NAME.csv; yield the names.

    Raises:
        StoreError: If the disk does not take them.
    """
    for name, figure in figures.items():
        untitled, caption = for_paper(figure)
        svg, pdf = _drawn(untitled, sheet)
        write_atomically(folder / f"{name}.txt", f"{caption}\n".encode("utf-8", errors="replace"))
        write_atomically(folder / f"{name}.svg", svg.encode("utf-8", errors="replace"))
        write_atomically(folder / f"{name}.pdf", pdf)
        points = as_csv(figure)
        if points is not None:
            write_atomically(folder / f"{name}.csv", points)
        yield name


def _drawn(figure: Figure, sheet: Sheet) -> tuple[str, bytes]:
    match figure:
        case Curves() | Maps():
            return static.draw(figure, sheet), static.draw_pdf(figure, sheet)
        case Picture():
            svg = _fitted(figure.svg, sheet)
        case Playback():
            svg = _fitted(figure.draw(sheet.width) if figure.draw else figure.still, sheet)
    return svg, _as_pdf(svg)


def _fitted(svg: str, sheet: Sheet) -> str:
    """Return a drawing of at most the width of the sheet: unchanged, or smaller as a whole while its text is read."""
    head, end, rest = svg.partition("<g ")
    width, height = _WIDTH.search(head), _HEIGHT.search(head)
    if width is None or height is None:
        return svg
    shrunk = min(1.0, max(_LEAST, sheet.width * _POINTS / float(width[1])))
    for size, found in (("width", width), ("height", height)):
        head = head.replace(found[0], f'{size}="{shrunk * float(found[1]):.6g}pt"')
    return head + end + rest


def tell_widths(figures: Mapping[str, Figure], sheet: Sheet) -> Iterator[str]:
    """Yield which drawings are wider than the sheet, as their text would be too small."""
    for name, figure in figures.items():
        found = _WIDTH.search(figure.svg.partition("<g ")[0]) if isinstance(figure, Picture) else None
        width = _LEAST * float(found[1]) / _POINTS if found else 0.0
        if width > sheet.width:
            yield f"{name} is {_MM * width:.0f} mm wide: in {_MM * sheet.width:.0f} mm its text is below 7 pt"


def _as_pdf(svg: str) -> bytes:
    """Return a drawing as PDF, a page of its size; its letters are outlines, as in the SVG."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "drawing.svg").write_text(svg, encoding="utf-8", errors="replace")
        source = '#set page(width: auto, height: auto, margin: 0pt)\n#image("drawing.svg")\n'
        (folder / "page.typ").write_text(source, encoding="utf-8")
        return typst.compile(folder / "page.typ", root=folder, format="pdf", ignore_system_fonts=True, timestamp=0,
                             pdf_standards=["1.4"])  # fmt: skip


def as_csv(figure: Figure) -> bytes | None:
    """Return all points of a figure, none left out, in the units that it shows; None for a drawing without any.

    A number that is missing or beyond every number is an empty field, as in the tables of sweeps.
    """
    rows = [
        ["" if isinstance(cell, float) and not math.isfinite(cell) else cell for cell in row] for row in _rows(figure)
    ]
    return csv_text(rows).encode("utf-8", errors="replace") if rows else None


def _rows(figure: Figure) -> Iterator[Row]:
    match figure:
        case Curves():
            yield ("panel", "curve", "x axis", "x", "y axis", "y", "low", "median", "high")
            for panel in figure.panels:
                for series in panel.series:
                    yield from _of_curve(panel, series)
        case Maps():
            yield ("panel", "x axis", "x", "y axis", "y", "quantity", "value")
            for each in figure.panels:
                for y, row in zip(each.y_names, each.values.tolist(), strict=True):
                    for x, value in zip(each.x_names, row, strict=True):
                        yield (each.title, each.x_label, x, each.y_label, y, figure.value_label, value)
        case Playback():
            yield ("curve", "x (m)", "y (m)", "z (m)")
            for name, path in (("path of the tip", figure.path), ("desired path", figure.desired)):
                for point in [] if path is None else path.tolist():
                    yield (name, *point)
        case Picture():
            pass


def _of_curve(panel: Panel, series: Series) -> Iterator[Row]:
    """Yield the points of a curve: y of a point, or the ends of its band or bar and what is between them."""
    name = series.name or series.label
    nothing = [math.nan] * series.x.size
    low, high = (nothing if edge is None else edge.tolist() for edge in (series.low, series.high))
    for x, y, *ends in zip(series.x.tolist(), series.y.tolist(), low, high, strict=True):
        place = panel.x_names[int(x)] if panel.x_names and x == int(x) and 0 <= x < len(panel.x_names) else x
        numbers = (y, math.nan, math.nan, math.nan) if series.low is None else (math.nan, ends[0], y, ends[1])
        yield (panel.title, name, panel.x_label, place, panel.y_label, *numbers)
