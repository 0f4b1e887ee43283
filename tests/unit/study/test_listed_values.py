"""Numbers over the runs that patterns stand for, and tables whose cells are in the chapter."""

import numpy as np
import pytest
from support.made_up_runs import made_up_run, planned

from runner.base.errors import RunnerError
from runner.papers.study import check as trying
from runner.papers.study.measured import Measured
from runner.papers.study.prose import read_chapter
from runner.papers.study.prose.blocks import config, count, each
from runner.papers.study.prose.plots import over, panel
from runner.papers.study.prose.signals import moved, part, scaled, setting
from runner.papers.study.prose.tables import listing


def pressed(stiffness, failed=False):
    """Return a run against a wall of a stiffness."""
    motion = {"t": [0.0, 1.0], "tip_x": [2.0, 2.5]}
    wall = {"stiffness": stiffness, "normal": [0.0, -1.0, 2.0]}
    return made_up_run(trace=motion, config={"wall": wall}, failed=failed)


WALLS = {"wall/soft": pressed(10.0), "wall/hard": pressed(1000.0), "wall/gone": pressed(5.0, True)}
RUNS = planned("wall/{case}", {**WALLS, "free": pressed(0.0)})


def test_a_number_of_each_run_is_none_where_it_failed():
    found = each(RUNS, "stiffness", scaled(2.0, setting("wall.stiffness")), "N/m", "wall/{case}", "free")
    assert [own.value for own in found] == [20.0, 2000.0, None, 0.0]
    assert found[0].name == "stiffness of wall/soft"


def test_a_number_of_some_runs_alone():
    hard = each(RUNS, "k", setting("wall.stiffness"), "N/m", "wall/{case}", only=lambda own: own.hash == "none")
    assert hard == []
    assert part(lambda own: {"k": setting("wall.stiffness")(own)}, "k", 2.0)(RUNS["wall/soft"]) == 20.0


def test_a_logarithmic_axis_leaves_zeros_out():
    levels = planned("at/{level}", {"at/0": pressed(0.0), "at/2": pressed(4.0)})
    series = over(levels, "at/{level}", "level", setting("wall.stiffness"), x_factor=1000.0)
    drawn = panel("", "x", "y", series, x_log=True).series[0]
    np.testing.assert_array_equal(drawn.x, [2000.0])
    np.testing.assert_array_equal(drawn.y, [4.0])
    np.testing.assert_array_equal(panel("", "x", "y", series).series[0].x, [0.0, 2000.0])


def test_runs_are_counted():
    assert count(RUNS, "walls", None, "wall/{case}").value == 3
    assert count(RUNS, "hard ones", lambda own: setting("wall.stiffness")(own) > 100.0, "wall/{case}").value == 1


def test_a_key_of_no_config_is_refused_with_the_nearest():
    assert config(RUNS, "free", "wall.stiffness") == 0.0
    with pytest.raises(RunnerError, match=r"no key wall.stifness in a config \(did you mean stiffness\?\)"):
        setting("wall.stifness")(RUNS["free"])
    with pytest.raises(RunnerError, match=r"no key wall.normal.3 in a config"):
        setting("wall.normal.3")(RUNS["free"])


def test_a_vector_of_a_config_has_arithmetic_and_items():
    np.testing.assert_array_equal((2 * setting("wall.normal"))(RUNS["free"]), [0.0, -2.0, 4.0])
    assert setting("wall.normal.2", 10)(RUNS["free"]) == 20.0


def test_a_signal_from_where_it_begins():
    np.testing.assert_array_equal(moved("tip_x")(RUNS["free"]), [0.0, 0.5])


def test_a_listing_shows_texts_numbers_and_measured_values():
    table = listing(RUNS, "What", "free", ["word", "number"], ["a", 0.25], ["b", Measured("c", 3e-14)])
    assert table.lines[1:] == [["a", "0.25"], ["b", "0 (rounding)"]]
    assert [column.kind for column in table.columns] == ["text", "number"]


def test_each_value_of_a_group_is_changed_in_turn():
    group = {"a": Measured("a", 1.0), "b": [Measured("b", 2.0)]}
    box = "::: finding A\nSo.\nholds: group.a < group.b[0]\nholds: 1 < given().a * 2\n:::\n"
    text = f"# T\n\n{{% set group = given() %}}\n\n{box}"
    assert len(trying.never_failing("a.md", read_chapter("a.md", text, {"given": lambda: group}))) == 1
