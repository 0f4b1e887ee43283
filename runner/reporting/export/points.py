"""Points of a figure as CSV, in the columns of the HTML report's download."""

import csv
import io
import math
from collections.abc import Iterator, Sequence

from runner.base.sanitize import table_cell
from runner.reporting.charts.figure import Panel, Series
from runner.reporting.charts.units import in_readable_units, map_in_readable_units
from runner.reporting.document import Curves, Maps, Picture, Playback

Figure = Curves | Maps | Picture | Playback
Row = Sequence[object]


def as_csv(figure: Figure) -> bytes | None:
    """Return all points of a figure, none left out, in the units that it shows; None for a drawing without any."""
    rows = list(_rows(figure))
    if not rows:
        return None
    stream = io.StringIO(newline="")
    writer = csv.writer(stream)
    writer.writerows([table_cell(str(value)) for value in row] for row in rows)
    return stream.getvalue().encode("utf-8", errors="replace")


def _rows(figure: Figure) -> Iterator[Row]:
    match figure:
        case Curves():
            yield ("panel", "curve", "x axis", "x", "y axis", "y")
            for panel in in_readable_units(figure.panels, figure.columns):
                for series in panel.series:
                    yield from _of_curve(panel, series)
        case Maps():
            yield ("panel", "x axis", "x", "y axis", "y", "quantity", "value")
            shown = map_in_readable_units(figure)
            for each in shown.panels:
                for y, row in zip(each.y_names, each.values.tolist(), strict=True):
                    for x, value in zip(each.x_names, row, strict=True):
                        yield (each.title, each.x_label, x, each.y_label, y, shown.value_label, _number(value))
        case Playback():
            yield ("curve", "x (m)", "y (m)", "z (m)")
            for name, path in (("path of the tip", figure.path), ("desired path", figure.desired)):
                for point in [] if path is None else path.tolist():
                    yield (name, *map(_number, point))
        case Picture():
            pass


def _of_curve(panel: Panel, series: Series) -> Iterator[Row]:
    edges = (("", series.y), (" (lower edge of its band)", series.low), (" (upper edge of its band)", series.high))
    for what, heights in edges:
        for x, y in [] if heights is None else zip(series.x.tolist(), heights.tolist(), strict=True):
            place = panel.x_names[int(x)] if panel.x_names and x == int(x) else _number(x)
            yield (panel.title, f"{series.name or series.label}{what}", panel.x_label, place, panel.y_label, _number(y))


def _number(value: float) -> object:
    """Return a number with all its digits; nothing for one that is missing."""
    return "" if math.isnan(value) else value
