"""Workers and commands killed at random moments of a sweep; `python -m bench kills` is the long form."""

import pytest

from bench.kills import torture


@pytest.mark.parametrize("trace", ["all", "never"])
def test_kills_lose_double_and_leave_nothing(tmp_path, trace):
    grid = ("robot=macro", "plant=rk4", "noise=thesis", "seed=range(0,40)", "repetitions=4", f"sweep.trace={trace}")
    tally = torture(tmp_path, list(grid), workers=2, commands=1, seed=2, pause=0.2)
    assert (tally.runs, tally.lost, tally.doubled, tally.leftovers) == (40, 0, 0, [])
