"""Model mismatch between the controllers' nominal model and the simulated robot."""

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.base.lazy_modules import pin
from runner.plugins.registry import KindConfig, Registry
from runner.robots.model import RobotModel
from runner.robots.robot import Robot, with_models
from runner.schema.model import StrictModel
from runner.schema.units import Kilograms


class MismatchConfig(StrictModel):
    """Error of the controllers' nominal model; with all factors 1 and all other values 0, the model is exact.

    Attributes:
        kind: Name in the registry.
        mass: Factor on the mass and inertia of every moving link, including its load.
        centre_of_mass: Factor on the distance of every link's centre of mass from its joint.
        length: Factor on every length from the base to the tip, and therefore on the tip position.
        gravity: Factor on gravity.
        payload: Additional point mass in the nominal model at the position of the payload, in kg; below 0 for a payload
            that is missing in the nominal model.
        spread: Largest random relative error of the mass and the centre of mass of each link, in addition to the
            factors. It is uniformly distributed and drawn again for each link in each repetition.
    """

    kind: Literal["factors"] = "factors"
    mass: PositiveFloat
    centre_of_mass: NonNegativeFloat
    length: PositiveFloat
    gravity: NonNegativeFloat
    payload: Kilograms[float]
    spread: Annotated[float, Field(ge=0.0, lt=1.0)]


NONE = MismatchConfig(mass=1.0, centre_of_mass=1.0, length=1.0, gravity=1.0, payload=0.0, spread=0.0)


def _check_nominal(nominal: Any, _: object, robot: Robot, *__: object) -> Robot:
    """Return the checked nominal robot of a user-supplied mismatch.

    Raises:
        ConfigError: if it is not a robot with the stages and joints of the simulated one, or if its masses or lengths
            are not finite.
    """
    if not isinstance(nominal, Robot):
        raise ConfigError(f"mismatch.kind: build gave {nominal!r:.200}; it must give a Robot")
    if nominal.stage_names != robot.stage_names or nominal.model.joint_names != robot.model.joint_names:
        raise ConfigError(
            "mismatch.kind: build gave a robot with other stages or joints: "
            f"{', '.join(nominal.model.joint_names)}; they must be {', '.join(robot.model.joint_names)}"
        )
    for model in (nominal.model, *(stage.model for stage in nominal.stages)):
        lengths = [placement.translation for placement in model.pin_model.jointPlacements]
        if not all(np.isfinite(part).all() for part in (model.inertial_parameters, model.gravity, np.array(lengths))):
            raise ConfigError("mismatch.kind: build gave a robot with masses or lengths that are not finite")
    return nominal


MISMATCHES = Registry[KindConfig, [Robot, np.random.Generator], Robot](
    "mismatch", {"factors": "runner.robots.mismatch"}, _check_nominal, default="factors"
)
"""`build` takes the simulated robot and a random generator, and returns the nominal robot."""


CONFIG = MismatchConfig


def build(config: MismatchConfig, robot: Robot, generator: np.random.Generator) -> Robot:
    """Return the nominal robot, with the mismatch applied to the model of the robot and of each stage."""
    if config == NONE:
        return robot
    factors = 1.0 + config.spread * generator.uniform(-1.0, 1.0, (robot.model.nq, 2))

    def change(model: RobotModel, joints: slice, bears_payload: bool) -> RobotModel:
        loaded = model.with_payload(config.payload, np.array(robot.payload_position)) if bears_payload else model
        masses, centres = (factors[joints] * (config.mass, config.centre_of_mass)).T
        return scale_model(loaded, masses, centres, np.full(len(masses) + 1, config.length), config.gravity)

    return with_models(robot, change)


def scale_model(
    model: RobotModel, masses: FloatArray, centres: FloatArray, lengths: FloatArray, gravity: float = 1.0
) -> RobotModel:
    """Return a model with scaled masses, lengths and gravity.

    Args:
        model: The model.
        masses: Factor on the mass and inertia of each moving link, including its load, shape (nq,).
        centres: Factor on the distance of each link's centre of mass from its joint, shape (nq,).
        lengths: Factor on all lengths of the base and of each link, from its joint to its frames, shape (nq + 1,).
        gravity: Factor on gravity.
    """

    def scale(own: "pin.Model") -> None:
        for joint, (mass, centre) in enumerate(zip(masses, centres, strict=True), start=1):
            own.inertias[joint] = _scale(own.inertias[joint], mass, centre)
            own.jointPlacements[joint].translation *= lengths[own.parents[joint]]
        for frame in own.frames:
            if frame.parentJoint:  # the inertia of a fixed body, such as a tool, is part of the link's inertia
                place, link = frame.placement, frame.parentJoint - 1
                frame.inertia = place.actInv(_scale(place.act(frame.inertia), masses[link], centres[link]))
            frame.placement.translation *= lengths[frame.parentJoint]
        own.gravity.linear = gravity * model.gravity

    return model.with_change(scale)


def _scale(inertia: "pin.Inertia", mass: float, centre: float) -> "pin.Inertia":
    return pin.Inertia(mass * inertia.mass, centre * inertia.lever, mass * inertia.inertia)
