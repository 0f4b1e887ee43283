"""Ready-made sweeps: their corners compose, and axes lie on both sides of the line of theory."""

import itertools

import pytest
import yaml

from runner.assembly.validation import validate
from runner.base.paths import conf_dir
from runner.config.compose.compose import compose
from runner.config.compose.files import group_options

NAMES = [name for name in group_options("experiment") if name.startswith("sweep/")]


def axes_of(name):
    params = yaml.safe_load((conf_dir() / "experiment" / f"{name}.yaml").read_text())["hydra"]["sweeper"]["params"]
    return {key: str(values).split(",") for key, values in params.items()}


def test_there_are_ready_made_sweeps():
    assert len(NAMES) >= 4


@pytest.mark.parametrize("name", NAMES)
def test_the_corners_of_a_ready_made_sweep_can_be_run(name):
    axes = axes_of(name)
    assert all(len(values) > 1 for values in axes.values())
    for corner in itertools.product(*((values[0], values[-1]) for values in axes.values())):
        cell = [f"{key}={value}" for key, value in zip(axes, corner, strict=True)]
        config = validate(compose([f"experiment={name}", *cell]))
        assert config.settings.repetitions >= 6  # fewer give no intervals


def test_both_links_of_the_mini_weigh_the_same():
    override = "robot.stages.mini.masses.link2=0.4"
    robot = compose(["experiment=sweep/mini_mass_coupling", override]).resolved["robot"]
    assert robot["stages"]["mini"]["masses"] == {"link2": 0.4, "link3": 0.4}


def test_frequency_and_period_lie_on_both_sides_of_the_line_of_theory():
    frequencies, periods = (map(float, values) for values in axes_of("sweep/frequency_period").values())
    products = [rate * period for rate, period in itertools.product(list(frequencies), list(periods))]
    assert sum(product < 1.0 for product in products) > 9
    assert sum(product > 1.0 for product in products) > 9
