import pytest

from runner.plants.servo import ServoConfig


@pytest.fixture(scope="session")
def servo() -> ServoConfig:
    """Position servos that no torque controller has use for."""
    return ServoConfig(stiffness=1500.0, damping_ratio=1.0, period=1e-3, gravity_compensation=True, interpolate=True)
