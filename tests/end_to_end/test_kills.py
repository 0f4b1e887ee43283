"""Workers and commands killed at random moments of a sweep; `python -m bench kills` is the long form."""

import pytest

from bench.kills import torture


@pytest.mark.parametrize(
    ("trace", "kills", "processes"),
    [
        ("all", 1, 1),
        ("never", 1, 1),
        pytest.param("all", 1, 2, marks=pytest.mark.slow),
        pytest.param("all", 4, 2, marks=pytest.mark.slow),
        pytest.param("never", 4, 2, marks=pytest.mark.slow),
    ],
)
def test_kills_lose_double_and_leave_nothing(tmp_path, trace, kills, processes):
    grid = ("robot=macro", "plant=rk4", "noise=thesis", "seed=range(0,40)", "repetitions=4", f"sweep.trace={trace}")
    arguments = [*grid, f"hydra.sweeper.workers={processes}"]
    tally = torture(tmp_path, arguments, workers=kills, commands=1, seed=2, pause=0.2)
    assert (tally.runs, tally.lost, tally.doubled, tally.leftovers) == (40, 0, 0, [])
