"""Tangents of programs: the rule of each operation, choices, and loops that carry a state."""

import numpy as np
import pytest

from runner.symbolic.code import ACTING, GIVEN, PARS, ROWS, STATE, Block, Repeat
from runner.symbolic.expression import (
    absolute,
    expression,
    floor,
    less,
    place,
    round_to_even,
    select,
    sine_cosine,
    sqrt,
)
from runner.symbolic.program import Expressed, program
from runner.symbolic.tangent import with_tangents

WIDTHS = {"given": 1, "rows": 1, "state": 1, "scratch": 1, "pars": 1, "table": 3}
A = place(PARS, 0)


def with_tangent(name, ticks, between, a, rows=1, state=0.0, delay=0, varies=lambda *_: True):
    """Return a program's first row entry and its derivative by A, of shape (rows, 8), at eight values of A."""
    expressed = with_tangents(Expressed(ticks, between, WIDTHS, []), varies)
    frame = program(f"test tangent {name}", "a test", lambda: expressed, 8, ours=False).frame(rows, delay=delay)
    frame.pars[0], frame.pars[1], frame.state[0] = a, 1.0, state
    frame.call()
    return frame.rows[:, 0].copy(), frame.rows[:, 1].copy()


SAMPLES = np.array([-2.5, -1.2, -0.7, -0.1, 0.3, 0.9, 1.7, 3.1])


@pytest.mark.parametrize(
    ("name", "value", "derivative"),
    [
        ("sum", 3.0 + A + A - (1.0 - A), lambda a: 3.0 + 0.0 * a),
        ("product", A * A * A, lambda a: 3.0 * a**2),
        ("quotient", (1.0 + A) / (2.0 + A * A), lambda a: (2.0 + a**2 - 2.0 * a * (1.0 + a)) / (2.0 + a**2) ** 2),
        ("negative", -(A * A), lambda a: -2.0 * a),
        ("size", absolute(A) * 2.0, lambda a: 2.0 * np.sign(a)),
        ("root", sqrt(2.0 + A * A), lambda a: a / np.sqrt(2.0 + a**2)),
        ("sine", sine_cosine(3.0 * A)[0], lambda a: 3.0 * np.cos(3.0 * a)),
        ("cosine", sine_cosine(3.0 * A)[1], lambda a: -3.0 * np.sin(3.0 * a)),
        ("branch", select(less(A, 0.0), A * A, 5.0 * A), lambda a: np.where(a < 0.0, 2.0 * a, 5.0)),
        ("steps", round_to_even(A) + floor(A) + expression(1.0), lambda a: 0.0 * a),
        ("one branch", select(less(A, 0.0), 1.0, A), lambda a: np.where(a < 0.0, 0.0, 1.0)),
    ],
    ids=["sum", "product", "quotient", "negative", "size", "root", "sine", "cosine", "branch", "steps", "one branch"],
)
def test_each_operation_has_its_rule(name, value, derivative):
    found = with_tangent(name, [Block([(ROWS, 0, value)])], [], SAMPLES)[1][0]
    np.testing.assert_allclose(found, derivative(SAMPLES), rtol=4e-15, atol=4e-15)


def test_a_root_of_nothing_leaves_no_nan():
    root = select(less(0.0, absolute(A)), sqrt(absolute(A) - absolute(A)), A)
    assert with_tangent("root of zero", [Block([(ROWS, 0, root)])], [], SAMPLES)[1].tolist() == [[0.0] * 8]


def test_a_state_carries_its_tangent_from_tick_to_tick():
    s = place(STATE, 0)
    grow = [Repeat([Block([(STATE, 0, s * A)])], 2)]
    rows, slopes = with_tangent("growth", [Block([(ROWS, 0, s)])], grow, SAMPLES, rows=5, state=3.0)
    powers = 2.0 * np.arange(5)[:, None]
    np.testing.assert_allclose(rows, 3.0 * SAMPLES**powers, rtol=1e-14)
    np.testing.assert_allclose(slopes, 3.0 * powers * SAMPLES**powers / SAMPLES, rtol=1e-14)


def test_what_acts_late_changes_late():
    s, late = place(STATE, 0), place(ACTING, 0)
    shown = Block([(ROWS, 0, s + A)])
    slopes = with_tangent("late", [shown], [Block([(STATE, 0, late)])], SAMPLES, rows=5, delay=2)[1]
    # Rows: A; then what acted of row max(k - 2, 0), and A again.
    assert slopes[:, 0].tolist() == [1.0, 2.0, 2.0, 2.0, 3.0]


def test_what_does_not_vary_costs_nothing():
    program_ = with_tangents(
        Expressed([Block([(ROWS, 0, place(GIVEN, 0) * A)])], [], WIDTHS, []), lambda space, _: space != PARS
    )
    (block,) = program_.ticks
    assert block.outputs[1][2].operation == "fmul"  # only of the given number's tangent and A
    nothing = with_tangents(Expressed([Block([(ROWS, 0, A * A)])], [], WIDTHS, []), lambda *_: False)
    assert nothing.ticks[0].outputs[1] == (ROWS, 1, 0.0)
