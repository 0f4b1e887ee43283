"""Checks of the payload: its mass in the nominal model, and changes during a run."""

from runner.base.errors import ConfigError
from runner.config.robot import RobotConfig
from runner.config.run import RunConfig
from runner.plants import PLANTS
from runner.robots.mismatch import MismatchConfig


def check_payload(robot: RobotConfig, mismatch: MismatchConfig) -> None:
    """Check that controllers believe in no payload below nothing.

    Raises:
        ConfigError: where they do.
    """
    if mismatch.payload < -robot.payload.mass:
        raise ConfigError(
            [
                f"mismatch.payload: {mismatch.payload:g} kg is less than nothing of the true payload, "
                f"robot.payload.mass with {robot.payload.mass:g} kg; allowed: {-robot.payload.mass:g} or more"
            ]
        )


def check_schedule(config: RunConfig) -> None:
    """Check that a payload that changes on the way meets a plant that can take it up.

    Raises:
        ConfigError: where it does not.
    """
    if not config.loaded:
        return
    key = "robot.payload.schedule: the payload cannot change on the way"
    if PLANTS.commands(config.plant.kind) == "position":
        fit = " or plant=".join(kind for kind in PLANTS.names() if PLANTS.commands(kind) == "torque")
        raise ConfigError([f"{key} of plant={config.plant.kind}, whose joints no mass moves; take plant={fit}, or []"])
    if config.has_contact:
        raise ConfigError(
            [
                f"{key} where the tip touches something or its sensor is read, which would have to tell the payload "
                "from the touch; take environment=free and a controller that feels nothing, or []"
            ]
        )
