"""Random expressions, half of them hostile: each has a value or is refused, runs no code, opens no file, is small."""

import tracemalloc
from contextlib import suppress

import numpy as np
import pytest
from support.hostile_expressions import attempt, expression

from runner.papers.audit.evaluation import evaluate
from runner.papers.expressions.grammar import ExpressionError
from runner.papers.expressions.parser import parse

SEED, COUNT = 1, 20_000
BYTES = 50_000_000


def test_an_expression_follows_from_its_number():
    assert [expression(SEED, n) for n in range(20)] == [expression(SEED, n) for n in range(20)]
    assert expression(SEED, 3) != expression(SEED + 1, 3)


@pytest.mark.parametrize("number", range(200))
def test_some_of_them(number):
    assert attempt(expression(SEED, number)).faults == ()


def test_a_printed_formula_has_a_value_or_is_refused():
    symbols = {"x": np.array([1.0, 2.0]), "n": np.array([3.0, 0.0])}
    with_value = 0
    for number in range(500):
        with suppress(ExpressionError):
            assert evaluate(parse(expression(SEED, number)), symbols).shape == (2,)
            with_value += 1
    assert 10 < with_value < 100


@pytest.mark.slow
def test_all_of_them():
    """The numbers are printed, so that `python -m tools.fuzz.expressions --only N` shows one."""
    faults, refused = {}, []
    tracemalloc.start()
    try:
        for number in range(COUNT):
            text = expression(SEED, number)
            before = tracemalloc.get_traced_memory()[0]
            tracemalloc.reset_peak()
            ended = attempt(text)
            taken = tracemalloc.get_traced_memory()[1] - before
            refused.append(ended.refused)
            if ended.faults or taken > BYTES:
                faults[number] = (*ended.faults, f"{taken} bytes")
    finally:
        tracemalloc.stop()
    assert faults == {}
    assert 0.1 * COUNT < sum(refused) < 0.95 * COUNT, "one half or the other tries nothing"
