"""Check of the joint torque sensors that a force controller reads."""

from runner.base.errors import ConfigError
from runner.config.run import RunConfig
from runner.controllers.force.hybrid_force import HybridForceConfig


def check_reading(config: RunConfig) -> None:
    """Check that joints have torque sensors where a law reads the force from them.

    Raises:
        ConfigError: where they have none.
    """
    law = config.controller
    if isinstance(law, HybridForceConfig) and law.force_source == "joint_torque" and config.joint_torques is None:
        raise ConfigError(
            [
                "controller.force_source: joint_torque needs torque sensors in the joints, and "
                "joint_torque_sensor.noise is null; take joint_torque_sensor=ideal, or controller.force_source=wrist"
            ]
        )
