"""Consistent curve colours by name throughout a report."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from runner.reporting.charts import palette
from runner.reporting.document import Block, Curves, Document, Panel, Section, Series
from runner.reporting.outline import blocks


def color_series(document: Document) -> Document:
    """Return a report in which all curves of one name have one palette index, unless their figure chose another.

    A name has the index that its meaning or the first figure that chose one gives it, otherwise the first that no
    curve beside it has, in any panel of the report.
    """
    panels = [panel for block in blocks(document) if isinstance(block, Curves) for panel in block.panels]
    found = _by_name(panels)
    return replace(document, sections=[_section(section, found) for section in document.sections])


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


def _section(section: Section, found: Mapping[str, int]) -> Section:
    shown: list[Block] = [
        replace(block, panels=[replace(panel, series=list(_series(panel, found))) for panel in block.panels])
        if isinstance(block, Curves)
        else block
        for block in section.blocks
    ]
    return replace(section, blocks=shown, sections=[_section(each, found) for each in section.sections])


def _series(panel: Panel, found: Mapping[str, int]) -> Iterator[Series]:
    taken = {series.color for series in panel.series}
    for series in panel.series:
        color = found.get(series.name)
        if series.color is None and color is not None and color not in taken:
            taken.add(color)
            yield replace(series, color=color)
        else:
            yield series
