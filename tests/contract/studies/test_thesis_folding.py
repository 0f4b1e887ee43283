"""The thesis' section on folding, from repetitions that partly diverge and from two draws that part."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
import pyarrow
import pytest
from fixtures.studies import Made

from runner.papers.studies.thesis import figures, folding
from runner.store import Run

NAME = "folding/full_equations/tip_goal/quintic"


@pytest.fixture
def runs(made: Callable[[str], Made]) -> Mapping[str, Run]:
    return made("thesis").runs


def ending(run: Run, errors: Sequence[float | None]) -> Run:
    """Return a run whose repetitions end with these steady-state errors, in m; one with None has diverged."""
    there = {"steady_state_error": {"unit": "m", "values": list(errors)}} if any(errors) else {}
    changed = replace(run, record={**run.record, "metrics": there})
    changed.__dict__["config"] = {**run.config, "repetitions": len(errors)}
    return changed


@pytest.mark.parametrize(
    ("errors", "diverging", "farthest"),
    [([0.016, None, 0.18], 1, 0.18), ([0.0001, 0.0001], 0, 0.0001), ([None, None], 2, None)],
)
def test_repetitions_that_diverge_are_counted_and_the_others_told(
    runs: Mapping[str, Run],
    errors: list[float | None],
    diverging: int,
    farthest: float | None,
) -> None:
    run = ending(runs[NAME], errors)
    assert figures.count_diverging(run) == diverging
    assert figures.farthest_at_rest(run) == farthest


def test_two_draws_part_when_their_joints_are_a_radian_apart(runs: Mapping[str, Run]) -> None:
    first, second = (replace(runs[NAME]) for _ in range(2))
    parting = first.t[3]
    apart = np.where(first.t < parting, 1e-12, 2.0)
    q2 = first._table.column_names.index("q2")
    second.__dict__["_table"] = first._table.set_column(q2, "q2", pyarrow.array(first.signal("q2") + apart))
    assert folding.parted_at(first, second) == pytest.approx(parting)
    assert folding.parted_at(first, first) is None
    second.__dict__["_table"] = second._table[:3]  # diverged
    assert folding.parted_at(first, second) is None
