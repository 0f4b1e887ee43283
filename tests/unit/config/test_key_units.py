"""The unit of each key against a table by hand."""

import pytest

from runner.config.compose.units import key_unit


@pytest.mark.parametrize(
    ("key", "unit"),
    [
        ("noise.position", "rad"),
        ("noise.position.mini", "rad"),
        ("controller.period", "s"),
        ("controller.natural_frequency.macro", "rad/s"),
        ("controller.damping_ratio", "1"),
        ("controller.null_space.gain", "1/s"),
        ("controller.stiffness", "N/m"),
        ("environment.stiffness", "N/m"),
        ("environment.frequency", "Hz"),
        ("plant.friction.viscous", "N m s/rad"),
        ("plant.friction.coulomb", "N m"),
        ("plant.friction.coulomb.q2", "N m"),
        ("plant.friction.stribeck_speed", "rad/s"),
        ("plant.friction.sigmoid.steepness", "s/rad"),
        ("robot.masses.link3", "kg"),
        ("robot.payload.mass", "kg"),
        ("robot.stages.mini.masses.link3", "kg"),
        ("robot.stages.mini.mount.rotation", "rad"),
        ("torque_limits.max", "N m"),
        ("trajectory.duration", "s"),
        ("duration", "s"),
        ("gravity", "m/s^2"),
        ("repetitions", "1"),
        ("mismatch.mass", "1"),
        ("mismatch.payload", "kg"),
        ("robot", "1"),
        ("controller", "1"),
        ("controler.period", "1"),
        ("nothing.of.this", "1"),
    ],
)
def test_the_unit_of_a_key(key, unit):
    assert key_unit(key) == unit
