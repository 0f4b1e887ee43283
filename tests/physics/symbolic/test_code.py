"""Programs in a few lines: arithmetic, loops, delays, and state between two ticks."""

import numpy as np
import pytest

from runner.base.paths import package_dir
from runner.symbolic import program as program_module
from runner.symbolic.code import ACTING, GIVEN, ROWS, SCRATCH, STATE, Block, Repeat
from runner.symbolic.expression import (
    absolute,
    both,
    equal,
    expression,
    floor,
    less,
    negated,
    place,
    round_to_even,
    select,
    sqrt,
)
from runner.symbolic.program import Expressed, program

WIDTHS = {"given": 2, "rows": 3, "state": 2, "scratch": 4, "pars": 1, "table": 3}
A, B = place(GIVEN, 0), place(GIVEN, 1)


def frame_of(name, ticks, between, rows, lanes, **chosen):
    code = program(f"test {name}", "a test", lambda: Expressed(ticks, between, WIDTHS, []), lanes, ours=False)
    return code.frame(rows, **chosen)


@pytest.mark.parametrize("lanes", [1, 8])
@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        ("sum", A + B - 2.0 * A / B, lambda a, b: a + b - 2.0 * a / b),
        ("root", sqrt(absolute(A)), lambda a, b: np.sqrt(np.abs(a))),
        ("whole", round_to_even(A) + floor(B), lambda a, b: np.round(a) + np.floor(b)),
        ("half", round_to_even(expression(2.5)) + A * 0.0, lambda a, b: 2.0 + 0.0 * a),
        ("less", select(less(A, B), A, -B), lambda a, b: np.where(a < b, a, -b)),
        ("both", select(both(less(A, B), negated(equal(A, 1.0))), 1.0, 0.0), lambda a, b: 1.0 * ((a < b) & (a != 1.0))),
    ],
    ids=["sum", "root", "whole", "half", "less", "both"],
)
def test_arithmetic_is_numpy_s_in_every_lane(name, value, expected, lanes):
    frame = frame_of(name, [Block([(ROWS, 0, value)])], [], 50, lanes)
    frame.given[:] = np.random.default_rng(1).normal(size=frame.given.shape) * 3.0
    frame.given[0] = 1.0
    frame.call()
    np.testing.assert_array_equal(frame.rows[:, 0], expected(frame.given[:, 0], frame.given[:, 1]))


def test_a_block_reads_before_it_writes():
    swap = Block([(STATE, 0, place(STATE, 1)), (STATE, 1, place(STATE, 0))])
    frame = frame_of("swap", [swap], [], 3, 1)
    frame.state[:, 0] = 1.0, 2.0
    frame.call()
    assert frame.state[:, 0].tolist() == [2.0, 1.0]


def test_nothing_moves_after_the_last_tick_and_ticks_can_be_done_in_parts():
    count = [Block([(STATE, 0, place(STATE, 0) + 1.0)])]
    kept = [Block([(ROWS, 0, place(STATE, 0))])]
    frame = frame_of("count", kept, count, 6, 1)
    for span in ((0, 2), (2, 3), (3, 6)):
        frame.span[:] = span
        frame.call()
    assert frame.rows[:, 0, 0].tolist() == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
    assert frame.state[0, 0] == 5.0


@pytest.mark.parametrize("delay", [0, 1, 3])
def test_what_acts_was_asked_some_ticks_ago_and_first_from_the_start(delay):
    acts = [Block([(STATE, 0, place(STATE, 0) + place(ACTING, 0))])]
    frame = frame_of("delay", [Block([(ROWS, 0, A), (ROWS, 1, place(STATE, 0))])], acts, 8, 1, delay=delay)
    frame.given[:, 0, 0] = 10.0 ** np.arange(8)
    frame.call()
    acted = frame.given[np.maximum(np.arange(8) - delay, 0), 0, 0]
    assert frame.rows[:, 1, 0].tolist() == [sum(acted[:k]) for k in range(8)]


def test_steps_are_repeated_as_often_as_is_said():
    double = Repeat([Block([(STATE, 0, place(STATE, 0) * 2.0)])], "steps")
    frame = frame_of("steps", [double], [], 1, 1, steps=5)
    frame.state[0] = 1.0
    frame.call()
    assert frame.state[0, 0] == 32.0


@pytest.mark.parametrize("lanes", [1, 8])
def test_a_search_ends_when_every_run_has_found(lanes):
    left = place(STATE, 0)
    less_one = select(less(0.0, left), left - 1.0, 0.0)
    turn = Block([(STATE, 0, less_one), (STATE, 1, place(STATE, 1) + 1.0), (SCRATCH, 2, less_one)])
    frame = frame_of("search", [Repeat([turn], 100, until_zero=2)], [], 1, lanes)
    frame.state[0] = 1.0 + np.arange(lanes)
    frame.call()
    assert (frame.state[0] == 0.0).all()
    assert (frame.state[1] == lanes).all()  # as many turns as the slowest needs


def test_a_table_has_a_row_for_each_turn():
    add = Block([(STATE, 0, place(STATE, 0) + place("table", 2))])
    frame = frame_of("table", [Repeat([add], 4, tabled=True)], [], 1, 1)
    frame.call()
    assert frame.state[0, 0] == 6.0  # 1 + 2 + 2 + 1, the weights of the Runge-Kutta scheme


def test_what_stands_twice_is_computed_once():
    from runner.symbolic.code import write_program

    text = write_program([Block([(ROWS, 0, (A + B) * (A + B)), (ROWS, 1, A + B)])], [], WIDTHS, 1)
    assert (text.count("fadd"), text.count("fmul")) == (1, 1)


@pytest.mark.parametrize("package", program_module.PACKAGES)
def test_kept_code_of_another_source_is_not_used(tmp_path, monkeypatch, package):
    file = tmp_path / package / "deep" / "law.py"
    file.parent.mkdir(parents=True)
    file.write_text("GAIN = 1.0")
    monkeypatch.setattr(program_module, "package_dir", lambda: tmp_path)
    before = program_module.source_digest.__wrapped__()
    file.write_text("GAIN = 2.0")
    assert program_module.source_digest.__wrapped__() != before


def test_the_source_of_kept_code_is_that_of_every_package_with_expressions():
    files = [path for path in package_dir().rglob("*.py") if "from runner.symbolic" in path.read_text()]
    users = {path.relative_to(package_dir()).parts[0] for path in files}
    assert users - {"api", "cli", "config", "store"} <= set(program_module.PACKAGES)  # these use its version and cache
    assert all((package_dir() / package).is_dir() for package in program_module.PACKAGES)
