"""A law in CI: the experiments of the benchmark, as docs/benchmark.md has them, and what `runner check` says."""

import pytest

from runner.config.compose.compose import compose
from runner.papers.study.study import load_study

SWEEP = ("-m", "experiment=benchmark/macro,benchmark/planar", "hydra.sweeper.workers=0", "repetitions=8")


@pytest.mark.parametrize("arm", ["macro", "planar", "xarm7"])
def test_an_experiment_is_what_the_benchmark_runs(arm):
    """Untuned computed torque on the circle, with all wrong at once; the names of the robot's defaults left aside."""
    overrides = load_study("benchmark").jobs()[f"first/{arm}/computed_torque/circle/all/untuned"]
    run, experiment = (compose(each).resolved for each in (overrides, [f"experiment=benchmark/{arm}"]))
    assert experiment == run


def test_a_law_is_held_against_what_it_did_before(cli):
    made = cli(*SWEEP, "controller=passivity")
    assert made.code == 0
    assert cli("check", made.folder, "--save-baseline", "passivity.json").code == 0
    assert cli("check", made.folder, "--baseline", "passivity.json").code == 0
    softer = cli(*SWEEP, "controller=passivity", "controller.natural_frequency=15")
    told = cli("check", softer.folder, "--baseline", "passivity.json")
    assert told.code == 1
    assert "rms_tracking_error" in told.out


def test_the_bands_that_come_with_it_hold(cli):
    good, soft = (cli("experiment=benchmark/macro", *more) for more in ((), ("controller.natural_frequency=15",)))
    assert cli("check", good.folder).code == 0
    assert cli("check", soft.folder).code == 1
