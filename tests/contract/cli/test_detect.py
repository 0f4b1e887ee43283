"""`--detect`: repetitions that show a difference, counted from a pilot, and lines that it rejects."""

import pytest
from support.engines import ASKED

import runner

TASK = ("-m", "plant=rk4", ASKED, "robot=macro", "trajectory=quintic", "trajectory.duration=0.5", "duration=0.6",
        "hydra.sweeper.workers=0")  # fmt: skip
GAINS = "controller.natural_frequency=20,40"
LINE = (*TASK, "noise=thesis", "noise.position=5e-3", GAINS)


@pytest.fixture(name="counted")
def _counted(cli):
    return cli(*LINE, "--detect", "20%")


@pytest.mark.costs(3)
def test_the_pilot_is_a_stored_sweep_that_python_counts_from_as_well(cli, counted):
    assert counted.code == 0
    lines = counted.out.splitlines()
    assert lines[0] == "To show 20 % of the larger median with a probability of 80 %:"
    sweep = runner.open_sweep(counted.folder)
    assert {run.config["repetitions"] for run in sweep.runs()} == {8}
    frame = sweep.repetitions_needed(0.2)
    first = frame.iloc[0]
    assert first["metric"] == "max_tracking_error"
    assert first["low"] <= first["repetitions"] <= first["high"]
    assert f"largest tracking error: repetitions={first['repetitions']}, about" in counted.out
    again = cli(*LINE, "--detect", "20%")
    assert (again.code, again.out) == (0, counted.out)
    assert "2 runs, 2 of them stored already" in again.err


@pytest.mark.costs(3)
def test_smaller_differences_need_more_and_the_step_bounds_them(counted):
    sweep = runner.open_sweep(counted.folder)
    some, frame = (sweep.repetitions_needed(share).set_index("metric") for share in (0.2, 0.05))
    assert frame.loc["cross_track_error", "repetitions"] > 3 * some.loc["cross_track_error", "repetitions"]
    assert frame.loc["peak_torque", "reason"].endswith("does not count: integration error")
    for share in (0.02, 1.1):
        with pytest.raises(runner.RunnerError, match=r"share: cannot be shown"):
            sweep.repetitions_needed(share)


def test_without_draws_one_repetition_is_exact(cli):
    ending = cli(*TASK, GAINS, "--detect", "10%")
    assert ending.code == 0
    assert "exact, because nothing is drawn" in ending.out
    assert "largest tracking error: repetitions=1, about" in ending.out


@pytest.mark.costs(2)
def test_probabilities_of_failing(cli):
    """Without a failure in the pilot, ln(0.025) / ln(1 - p) repetitions show a probability below p: 36 of 10 %."""
    bound = "spec.metrics.max_tracking_error.max=1m"
    ending = cli(*TASK, "noise=thesis", "noise.position=5e-4,1e-3", bound, "--detect", "10%")
    assert ending.code == 0
    assert "or a probability of failing other than 10 %:" in ending.out
    assert "largest tracking error at most 1 m: repetitions=36, " in ending.out
    assert "0 of 8 failed; if that share stays" in ending.out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([*LINE, "--detect", "2%"], "--detect: not a difference that can be shown ('2%'). Allowed: above 2% up"),
        ([*LINE, "--detect", "0.1"], "('0.1')"),
        ([*LINE, "--detect", "101%"], "('101%')"),
        ([*LINE, "repetitions=4", "--detect", "9%"], "repetitions: not with --detect"),
        ([*LINE, "sweep.part=1/2", "--detect", "9%"], "sweep.part: not with --detect"),
        ([*LINE, "--dry-run", "--detect", "9%"], "--detect: simulates a pilot, the other option nothing."),
        ([*LINE, "--slurm", "2", "--detect", "9%"], "--detect: simulates a pilot, the other option nothing."),
        (["robot=macro", "--detect", "9%"], "--detect: one run compares nothing. Add -m for a sweep."),
        (["-m", "robot=macro,mini", "--detect", "9%"], "because only conditions are swept (robot). Allowed:"),
    ],
)
def test_a_wrong_line_is_one_sentence_and_starts_nothing(cli, tmp_path, words, said):
    ending = cli(*words)
    assert ending.code == 2
    assert said in ending.err
    assert list(tmp_path.iterdir()) == []
