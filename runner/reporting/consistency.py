"""Curve colours by name, and readable units of figures, throughout a report."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

from runner.reporting.charts import palette
from runner.reporting.charts.scales import curves_in_readable_units, maps_in_readable_units
from runner.reporting.document import Curves, Document, Maps, Panel, ReportBlock, Section, Series
from runner.reporting.outline import blocks


def make_consistent(document: Document) -> Document:
    """Return a report with the same colours for the same names, and figures in the units that fit their numbers.

    All curves of one name have one palette index, unless their figure chose another: that of its meaning or of the
    first figure that chose one, otherwise the first that no curve next to it has, in any panel of the report.
    """
    panels = [panel for block in blocks(document) if isinstance(block, Curves) for panel in block.panels]
    found = _by_name(panels)

    def changed(block: ReportBlock) -> ReportBlock:
        if isinstance(block, Maps):
            return maps_in_readable_units(block)
        if not isinstance(block, Curves):
            return block
        panels = [replace(panel, series=list(_series(panel, found))) for panel in block.panels]
        return curves_in_readable_units(replace(block, panels=panels))

    return replace(document, sections=_changed(document.sections, changed))


def _by_name(panels: list[Panel]) -> dict[str, int]:
    named = [(panel, series) for panel in panels for series in panel.series if series.name]
    found = {series.name: series.color for _, series in reversed(named) if series.color is not None}
    found |= palette.MEANINGS
    beside: dict[str, list[Series]] = {}
    for panel, series in named:
        beside.setdefault(series.name, []).extend(panel.series)
    for name, others in beside.items():
        taken = {found.get(other.name, other.color) for other in others} | {other.color for other in others}
        found.setdefault(name, next(index for index in range(len(taken) + 1) if index not in taken))
    return found


def _series(panel: Panel, found: Mapping[str, int]) -> Iterator[Series]:
    taken = {series.color for series in panel.series}
    for series in panel.series:
        color = found.get(series.name)
        if series.color is None and color is not None and color not in taken:
            taken.add(color)
            yield replace(series, color=color)
        else:
            yield series


def _changed(sections: Sequence[Section], change: Callable[[ReportBlock], ReportBlock]) -> list[Section]:
    return [
        replace(each, blocks=list(map(change, each.blocks)), sections=_changed(each.sections, change))
        for each in sections
    ]
