"""`runner.compare` from Python against what `runner compare` prints of the same runs and sweeps."""

import pytest

import runner

SHORT = ("robot=macro", "trajectory=quintic", "noise=thesis", "duration=0.05", "repetitions=6")
COLUMNS = ["first", "second", "metric", "unit", "difference", "low", "high", "n", "effect", "p", "word"]


@pytest.fixture(scope="module")
def outputs(tmp_path_factory):
    return tmp_path_factory.mktemp("outputs")


@pytest.fixture(scope="module")
def runs(outputs):
    return [runner.run(*SHORT, outputs=outputs, controller__damping_ratio=ratio) for ratio in (1.0, 0.7, 0.5)]


@pytest.fixture(scope="module")
def sweeps(outputs):
    axes = {"robot": ["macro", "mini"], "outputs": outputs, "workers": 0}
    return [runner.sweep(*SHORT[1:], controller__damping_ratio=ratio, **axes) for ratio in (1.0, 0.7)]


def test_runs_are_compared_with_the_first_one(runs, cli):
    found = runner.compare(*runs, metrics=["peak_torque", "energy"])
    assert list(found.columns) == COLUMNS
    assert found[["first", "second"]].to_numpy().tolist() == [["A", "B"]] * 2 + [["A", "C"]] * 2
    assert found["n"].tolist() == [6] * 4
    printed = cli("compare", *(run.folder for run in runs), "--metrics", "peak_torque,energy", "--all").out
    for _, row in found.iterrows():
        assert any(
            line.split()[0] == row["metric"] and f"{row['difference']:.5g}" in line and row["word"] in line
            for line in printed.splitlines()
            if line
        )
    assert runner.compare(*(str(run.folder) for run in runs), metrics=["peak_torque", "energy"]).equals(found)


def test_sweeps_are_compared_in_the_cells_that_both_have(sweeps, runs):
    found = runner.compare(*sweeps, metrics="peak_torque")
    assert list(found.columns) == ["robot", *COLUMNS]
    assert found[["robot", "n"]].to_numpy().tolist() == [["macro", 6], ["mini", 6]]  # no number describes both
    assert found.summary == "6 pairs are too few for 3 comparisons: 7 would do."
    whole = runner.compare(*sweeps)
    assert len(whole) > 10
    assert "peak_torque" in set(whole["metric"])
    assert set(runner.compare(*runs)["first"]) == {"A"}


def test_runs_and_sweeps_are_not_mixed(runs, sweeps):
    with pytest.raises(runner.RunnerError, match="give only runs or only sweeps"):
        runner.compare(runs[0], sweeps[0])


def test_what_cannot_be_compared(runs, outputs):
    with pytest.raises(runner.RunnerError, match="nowhere: no such folder"):
        runner.compare(runs[0], "nowhere")
    with pytest.raises(runner.RunnerError, match=r"unknown metric 'peak_torqe'. .* Did you mean 'peak_torque'\?"):
        runner.compare(*runs, metrics="peak_torqe")
    other = runner.run(*SHORT, outputs=outputs, seed=1)
    with pytest.raises(runner.RunnerError, match="share no noise"):
        runner.compare(runs[0], other)
