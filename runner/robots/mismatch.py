"""Model mismatch between the controllers' nominal model and the simulated robot."""

from collections.abc import Iterable
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError, nearest
from runner.base.lazy_modules import pin
from runner.base.memory import Memory
from runner.plugins.registry import KindConfig, Registry
from runner.robots.drawn import DrawnModel
from runner.robots.model import RobotModel
from runner.robots.robot import Robot, with_models
from runner.schema.model import StrictModel
from runner.schema.units import Kilograms

Spread = Annotated[float, Field(ge=0.0, lt=1.0)]


class LinkMismatch(StrictModel):
    """Error of the nominal model of one link, in addition to the factors for all links.

    Attributes:
        mass: Factor on the mass and inertia of the link, including its load.
        centre_of_mass: Factor on the distance of its centre of mass from its joint.
        inertia: Factor on its inertia about its centre of mass.
        mass_spread: Largest random relative error of its mass; None for that of all links.
        centre_of_mass_spread: The same of its centre of mass.
        inertia_spread: Largest random relative error of its inertia about its centre of mass.
    """

    mass: PositiveFloat = 1.0
    centre_of_mass: NonNegativeFloat = 1.0
    inertia: PositiveFloat = 1.0
    mass_spread: Spread | None = None
    centre_of_mass_spread: Spread | None = None
    inertia_spread: Spread = 0.0

    @property
    def factors(self) -> tuple[float, float, float]:
        """Factors on mass, centre of mass and inertia."""
        return self.mass, self.centre_of_mass, self.inertia

    def spreads(self, common: float) -> tuple[float, float, float]:
        """Return the spreads of mass, centre of mass and inertia, given the spread for all links."""
        mass, centre = (common if own is None else own for own in (self.mass_spread, self.centre_of_mass_spread))
        return mass, centre, self.inertia_spread


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
        link: Error of single links, by the name of a moving link.
    """

    kind: Literal["factors"] = "factors"
    mass: PositiveFloat
    centre_of_mass: NonNegativeFloat
    length: PositiveFloat
    gravity: NonNegativeFloat
    payload: Kilograms[float]
    spread: Spread
    link: dict[str, LinkMismatch]

    @property
    def varies(self) -> bool:
        """True if each repetition has another nominal model."""
        return self.spread > 0.0 or any(any(link.spreads(0.0)) for link in self.link.values())

    def fixed(self) -> "MismatchConfig":
        """Return the errors without those that are drawn."""
        link = {name: LinkMismatch(**dict(zip(_TERMS, own.factors, strict=True))) for name, own in self.link.items()}
        return self.model_copy(update={"spread": 0.0, "link": link})

    def draw(self, links: tuple[str, ...], generators: Iterable[np.random.Generator]) -> FloatArray:
        """Return random factors on mass, centre of mass and inertia of each link, shape (runs, nq, 3).

        Args:
            links: Names of the moving links.
            generators: Generator of each run; it may be the same object with another state.
        """
        spreads = np.array([self._of(name).spreads(self.spread) for name in links])
        drawn = [_draw(generator, spreads) for generator in generators]
        return np.asarray(1.0 + spreads * np.array(drawn))

    def factors(self, links: tuple[str, ...]) -> FloatArray:
        """Return the fixed factors on mass, centre of mass and inertia of each link, shape (nq, 3)."""
        return np.array([self._of(name).factors for name in links]) * (self.mass, self.centre_of_mass, 1.0)

    def _of(self, name: str) -> LinkMismatch:
        return self.link.get(name, _NO_ERROR)


_TERMS = "mass", "centre_of_mass", "inertia"
_NO_ERROR = LinkMismatch()
_MEMORY = Memory(128)  # for nominal robots of errors that are not drawn
NONE = MismatchConfig(mass=1.0, centre_of_mass=1.0, length=1.0, gravity=1.0, payload=0.0, spread=0.0, link={})


def check_links(robot: Robot, mismatch: KindConfig) -> None:
    """Check the names of links in a built-in mismatch.

    Raises:
        ConfigError: if a link does not exist.
    """
    links = robot.model.link_names
    wrong = [name for name in mismatch.link if name not in links] if isinstance(mismatch, MismatchConfig) else []
    if wrong:
        raise ConfigError(
            f"mismatch.link.{name}: no such moving link{nearest(name, links)}; moving links: {', '.join(links)}"
            for name in wrong
        )


def _draw(generator: np.random.Generator, spreads: FloatArray) -> FloatArray:
    """Return uniform numbers between -1 and 1, shape (nq, 3); the last ones are drawn only if a spread needs them."""
    found = np.zeros(spreads.shape)
    found[:, :2] = generator.uniform(-1.0, 1.0, (len(spreads), 2))
    if spreads[:, 2].any():
        found[:, 2] = generator.uniform(-1.0, 1.0, len(spreads))
    return found


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


COMPILED = True
CONFIG = MismatchConfig


def build(config: MismatchConfig, robot: Robot, generator: np.random.Generator) -> Robot:
    """Return the nominal robot, with the mismatch applied to the model of the robot and of each stage."""
    if config == NONE:
        return robot
    return _built(config, robot, generator) if config.varies else _MEMORY.recall(_built, config, robot, None)


def _built(config: MismatchConfig, robot: Robot, generator: np.random.Generator | None) -> Robot:
    """Return the nominal robot; without a generator, that of an error that is not drawn."""
    links = robot.model.link_names
    factors = config.factors(links)
    if generator is not None:
        factors = config.draw(links, [generator])[0] * factors

    def change(model: RobotModel, joints: slice, bears_payload: bool) -> RobotModel:
        loaded = model.with_payload(config.payload, np.array(robot.payload_position)) if bears_payload else model
        masses, centres, inertias = factors[joints].T
        return scale_model(loaded, masses, centres, np.full(len(masses) + 1, config.length), config.gravity, inertias)

    return with_models(robot, change)


def build_drawn(config: MismatchConfig, robot: Robot, generators: Iterable[np.random.Generator]) -> Robot:
    """Return the nominal robot of several runs, with a generator for each, as a robot of DrawnModels.

    The random numbers are those of `build`, and its robots are equal to these up to rounding.
    """
    common, factors = (
        build(config.fixed(), robot, np.random.default_rng(0)),
        config.draw(robot.model.link_names, generators),
    )

    def change(model: RobotModel, joints: slice, _: bool) -> RobotModel:
        return DrawnModel(model, _scale_rows(model, factors[:, joints]))

    return with_models(common, change)


def _scale_rows(model: RobotModel, factors: FloatArray) -> FloatArray:
    """Return inertial parameters, shape (runs, nq, 10), from factors on mass, centre of mass and inertia."""
    rows = np.empty((len(factors), model.nq, 10))
    for body, inertia in enumerate(list(model.pin_model.inertias)[1:]):
        at_centre = pin.Inertia(inertia.mass, np.zeros(3), inertia.inertia).toDynamicParameters()[4:]
        offset = inertia.toDynamicParameters()[4:] - at_centre
        mass, centre, own = factors[:, body, :, None].transpose(1, 0, 2)
        rows[:, body, :1] = mass * inertia.mass
        rows[:, body, 1:4] = mass * centre * (inertia.mass * inertia.lever)
        rows[:, body, 4:] = mass * (own * at_centre + centre * centre * offset)
    return rows


def scale_model(
    model: RobotModel,
    masses: FloatArray,
    centres: FloatArray,
    lengths: FloatArray,
    gravity: float = 1.0,
    inertias: FloatArray | None = None,
) -> RobotModel:
    """Return a model with scaled masses, lengths and gravity.

    Args:
        model: The model.
        masses: Factor on the mass and inertia of each moving link, including its load, shape (nq,).
        centres: Factor on the distance of each link's centre of mass from its joint, shape (nq,).
        lengths: Factor on all lengths of the base and of each link, from its joint to its frames, shape (nq + 1,).
        gravity: Factor on gravity.
        inertias: Additional factor on the inertia of each moving link about its centre of mass, shape (nq,).
    """
    turns = np.ones(model.nq) if inertias is None else inertias

    def scale(own: "pin.Model") -> None:
        for joint, (mass, centre, turn) in enumerate(zip(masses, centres, turns, strict=True), start=1):
            own.inertias[joint] = _scale(own.inertias[joint], mass, centre, turn)
            own.jointPlacements[joint].translation *= lengths[own.parents[joint]]
        for frame in own.frames:
            if frame.parentJoint:  # the inertia of a fixed body, such as a tool, is part of the link's inertia
                place, link = frame.placement, frame.parentJoint - 1
                frame.inertia = place.actInv(_scale(place.act(frame.inertia), masses[link], centres[link], turns[link]))
            frame.placement.translation *= lengths[frame.parentJoint]
        own.gravity.linear = gravity * model.gravity

    return model.with_change(scale)


def _scale(inertia: "pin.Inertia", mass: float, centre: float, turn: float) -> "pin.Inertia":
    return pin.Inertia(mass * inertia.mass, centre * inertia.lever, mass * turn * inertia.inertia)
