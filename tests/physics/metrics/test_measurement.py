"""Caveats of a controller's knowledge: exact velocities, only noise, and exact models."""

import pytest
from support.caveat_runs import found, signals
from support.engines import ASKED

from runner.metrics.caveats import Watch, setting_of

NOISY = ("robot=macro", "noise.position=1e-3")


@pytest.mark.parametrize(
    ("overrides", "value"),
    [
        (NOISY, 1e-3),
        (("robot=macro", "noise.resolution=1e-4"), 1e-4),
        ((*NOISY, "noise.velocity=finite_difference"), None),
        (("robot=macro",), None),
        (("robot=macro", "noise.bias=1e-3"), None),  # a velocity does not see a zero that is set wrong
        ((*NOISY, "noise.distribution=none"), None),
        ((*NOISY, "caveats.exact_velocity.noise=1e-3"), None),
        (("robot=xarm7", "noise.position=1e-3"), None),  # it commands positions, and takes no velocities
    ],
)
def test_exact_velocities_beside_noisy_positions(checked_config, overrides, value):
    caveat = found(checked_config(*overrides)).get("exact_velocity")
    assert value == (caveat and caveat.value)
    if caveat:
        assert "noise.velocity: exact" in caveat.text


@pytest.mark.parametrize(
    ("overrides", "value"),
    [
        (("mismatch.mass=1.2", "repetitions=20"), 0.2),
        (("mismatch.gravity=0.9", "mismatch.length=1.01", "repetitions=2"), 0.1),
        (("mismatch.payload=0.5", "repetitions=2"), 0.25),  # on links of 2 kg
        (("mismatch.mass=1.2", "repetitions=1"), None),
        (("mismatch.link.link2.inertia=1.3", "repetitions=2"), 0.3),
        (("mismatch.link.link2={mass: 1.2, inertia_spread: 0.1}", "repetitions=2"), None),
        (("mismatch.mass=1.2", "mismatch.spread=0.1", "repetitions=20"), None),
        (("repetitions=20",), None),
        (("mismatch.mass=1.2", "repetitions=20", "caveats.fixed_mismatch.error=0.3"), None),
    ],
)
def test_repetitions_that_vary_noise_alone(checked_config, overrides, value):
    config = checked_config("robot=macro", ASKED, *overrides)
    caveats = {caveat.rule: caveat for caveat in Watch(setting_of(config), config.caveats).found().caveats}
    if value is None:
        assert caveats == {}
    else:
        assert caveats["fixed_mismatch"].value == pytest.approx(value)


def test_all_that_is_wrong_is_named(checked_config):
    config = checked_config("robot=macro", "mismatch.gravity=0.9", "mismatch.payload=1", "repetitions=2")
    text = found(config, signals(), signals())["fixed_mismatch"].text
    assert text.startswith("the 2 repetitions vary noise alone: mismatch.gravity, mismatch.payload are the same in all")
