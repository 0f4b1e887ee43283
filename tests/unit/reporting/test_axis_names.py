"""Names on axes: none is cut off, overlaps or is read as mathematics."""

import pytest
from matplotlib.figure import Figure

from runner.reporting.charts.sheet import REPORT, column, names_below, names_beside

LAWS = ["computed_torque", "operational_space"]
NARROW = column(88.0)


@pytest.mark.parametrize("sheet", [REPORT, NARROW, column(180.0)], ids=["report", "narrow", "column"])
@pytest.mark.parametrize("length", [0.9, 1.4, 2.5, 5.0])
def test_texts_below_an_axis_are_whole(sheet, length):
    names = names_below(LAWS, length, sheet)
    assert ["".join(label.split("\n")) for label in names.labels] == LAWS
    assert names.step == 1


def test_texts_are_broken_at_their_parts_or_turned():
    assert names_below(LAWS, 2.5, NARROW).labels == LAWS
    assert names_below(LAWS, 1.9, NARROW).labels == ["computed_\ntorque", "operational_\nspace"]
    turned = names_below(["unbreakablelongword"] * 4, 1.9, NARROW)
    assert turned.turned
    assert turned.room == pytest.approx(19 * NARROW.character)


def test_of_numbers_every_other_one_will_do():
    names = names_below([f"{value:g}" for value in range(100, 160)], 2.0, REPORT)
    assert names.step > 1
    assert not names.turned


def test_names_beside_an_axis_are_whole_and_tell_their_room():
    names = names_beside(LAWS, 1.3, NARROW)
    assert ["".join(label.split("\n")) for label in names.labels] == LAWS
    assert names.room == pytest.approx(len("operational_") * NARROW.character)


def test_a_dollar_sign_is_itself():
    axes = Figure().add_subplot()
    names_below(["$x$", "b"], 3.0, REPORT).put(axes.xaxis, 2)
    assert axes.get_xticklabels()[0].get_text() == r"\$x\$"
