"""Colours of curves through a whole report: one for a name, none for two names of a panel, green for stable."""

from itertools import combinations

import numpy as np
import pytest

from runner.reporting.consistency import make_consistent
from runner.reporting.document import Curves, Document, Panel, Section, Series
from runner.reporting.export.figures import figures_of

X = np.arange(2.0)


def document(*panels):
    """Return a report of panels, a figure each, every other one in a section below; a curve may be (name, colour)."""
    figures = []
    for number, curves in enumerate(panels):
        pairs = [curve if isinstance(curve, tuple) else (curve, None) for curve in curves]
        series = [Series(name, X, X, color=color) for name, color in pairs]
        figures.append(Curves(f"figure {number}", [Panel("", "x", "y", series)]))
    return Document("", "", "", [Section("a", figures[::2], [Section("b", figures[1::2])])], "")


def colors(made):
    """Return the colours of each figure by name, in the order in which a reader meets them."""
    (section,) = made.sections
    figures = [*section.blocks, *section.sections[0].blocks]
    return [{series.name: series.color for series in figure.panels[0].series} for figure in figures]


def test_a_name_keeps_its_colour_from_figure_to_figure():
    first, third, second = colors(make_consistent(document(["Macro", "Mini"], ["Mini", "third"], ["Mini"])))
    assert first["Mini"] == third["Mini"] == second["Mini"] == 1
    assert second["Mini"] != second.get("third")


def test_stable_is_green_and_unstable_orange_whatever_else_a_figure_has():
    for found in colors(
        make_consistent(document(["bound", "stable", "unstable"], ["unstable"], ["map", "bound", "stable"]))
    ):
        assert found.get("stable", 2) == 2
        assert found.get("unstable", 3) == 3
        assert len(set(found.values())) == len(found)


def test_a_colour_that_a_figure_chose_is_kept_and_taken_over_elsewhere():
    chosen, other, crowded = colors(make_consistent(document([("tip", 4)], [("a", 4), "tip"], ["tip", "b"])))
    assert chosen == {"tip": 4}
    assert other["tip"] == 4
    assert crowded["a"] == 4
    assert crowded["tip"] is None  # another curve of its figure has its colour: the drawing takes a free one


def test_two_curves_of_a_panel_with_one_name_do_not_share_its_colour():
    (section,) = make_consistent(document(["Mini", "Mini"])).sections
    first, second = section.blocks[0].panels[0].series
    assert (first.color, second.color) == (0, None)


def test_curves_without_a_name_stay_as_they_are():
    (found, *_) = colors(make_consistent(document([("", 3), "a"])))
    assert found == {"": 3, "a": 0}


@pytest.mark.parametrize("seed", range(3))
def test_no_two_names_of_a_panel_share_a_colour(seed):
    rng = np.random.default_rng(seed)
    names = [f"name {number}" for number in range(12)]
    panels = [list(rng.choice(names, 4, replace=False)) for _ in range(20)]
    of_name = {}
    for found in colors(make_consistent(document(*panels))):
        assert all(found[a] != found[b] for a, b in combinations(found, 2))
        of_name |= {name: of_name.setdefault(name, color) for name, color in found.items()}
        assert all(of_name[name] == color for name, color in found.items())


def test_figures_of_their_own_have_the_colours_of_the_report():
    made = document(["Macro", "Mini"], [], ["Mini"])
    figures = [figure for figure in figures_of(made).values() if figure.panels[0].series]
    assert [figure.panels[0].series[-1].color for figure in figures] == [1, 1]
    assert [series.color for series in made.sections[0].blocks[0].panels[0].series] == [None, None]
