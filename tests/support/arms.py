"""Arms that are shipped and configs of runs; files are read once in a process."""

import copy
import functools

from runner.assembly.run_config import RunConfig
from runner.assembly.validation import validate
from runner.config.compose.compose import compose
from runner.config.composed import Composed
from runner.controllers.operational_space.whole_body import WholeBodyLaw
from runner.robots.description import find_urdf, read_urdf
from runner.robots.model import RobotModel


@functools.cache
def urdf_of(name: str) -> str:
    """Return the text of a shipped URDF."""
    return read_urdf(find_urdf(f"{name}.urdf"), {})


def model_of(name: str, tip: str = "tip") -> RobotModel:
    """Return a model of a shipped URDF, a new one each time."""
    return RobotModel(urdf_of(name), tip)


def checked(*overrides: str) -> RunConfig:
    """Compose and check the config that overrides choose; a fresh one each time."""
    return validate(copy.deepcopy(_composed(*overrides)))


@functools.cache
def _composed(*overrides: str) -> Composed:
    return compose(overrides)


def last_of_each(*overrides: str) -> list[str]:
    """Return the overrides without those whose key is overridden again later."""
    return list({text.partition("=")[0]: text for text in overrides}.values())


def tip_numbers(
    natural_frequency: float, damping_ratio: float, gravity: bool, feedforward: bool, singularity_damping: float
) -> WholeBodyLaw:
    """Return the numbers of a law of the tip, whose null space is as quick."""
    return WholeBodyLaw(
        natural_frequency=natural_frequency,
        damping_ratio=damping_ratio,
        gravity_compensation=gravity,
        feedforward=feedforward,
        null_space_frequency=natural_frequency,
        max_tip_speed=None,
        singularity_damping=singularity_damping,
    )
