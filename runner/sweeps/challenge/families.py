"""Families of variations: what each changes in the configs of both sides, and when it does not apply."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any

from runner.base.quantities import number
from runner.plants import PLANTS
from runner.store.axes import override_value
from runner.sweeps.challenge.case import Case
from runner.sweeps.challenge.goals import ends_of
from runner.sweeps.challenge.question import Class, Value, Variation

_MOTION = ("trajectory", "robot")  # groups that all sides share if a goal is changed


class NotApplicableError(Exception):
    """A variation that does not apply; its text is the reason."""


@dataclass(frozen=True)
class SidesChange:
    """A change of all sides.

    Attributes:
        label: What is changed, such as "a motion of 6 s".
        sides: Overrides that each side gets.
        exact: True if no side draws anything with them.
    """

    label: str
    sides: Sequence[Sequence[str]]
    exact: bool = False


@dataclass(frozen=True)
class Family:
    """A family of variations.

    Attributes:
        kind: Its class.
        change: Function of a case and a value that returns the change; it raises LeftOutError.
        key: Key that the values scale or set; empty for none.
        neutral: Number at which nothing changes; None if values are no numbers.
        discrete: Allowed step of the numbers between the neutral and another one; None for a continuous choice.
    """

    kind: Class
    change: Callable[[Case, Value], SidesChange]
    key: str = ""
    neutral: float | None = None
    discrete: Callable[[Case], float] | None = None


def _engine(case: Case, value: Value) -> SidesChange:
    kinds = {config.plant.kind for config in case.configs}
    if not all(config.takes_torques for config in case.configs):
        raise NotApplicableError("the plant is not driven by torques")
    if kinds == {value}:
        raise NotApplicableError("")
    sides = []
    for config in case.configs:
        own = PLANTS.features(str(value)).default_step(config.timing.tick, len(config.arm.stages))
        coarse = config.plant.step is not None and config.timing.step > own  # of an engine of higher order
        sides.append([f"plant={value}", *(["plant.step=null"] if coarse else [])])
    return SidesChange(f"the engine {value}", sides)


def _step(case: Case, value: Value) -> SidesChange:
    if any(not config.takes_torques and config.plant.step is None for config in case.configs):
        raise NotApplicableError("the plant integrates nothing")
    divisor = max(2, math.ceil(1.0 / min(float(value), case.most_step) - 1e-9))
    steps = [config.timing.step / divisor for config in case.configs]
    return SidesChange(f"a step {divisor} times finer", [[f"plant.step={_text(step)}"] for step in steps])


def _goal(case: Case, value: Value) -> SidesChange:
    _needs_ends(case)
    goals = case.goals
    if len(goals) < int(value):
        raise NotApplicableError(
            f"only {len(goals)} other goals lie within reach and away from singular configurations"
        )
    point = [round(float(each), 6) for each in goals[int(value) - 1]]
    return _all(case, f"the goal {_text(point)} m", [f"trajectory.goal={_text(point)}"])


def _direction(case: Case, value: Value) -> SidesChange:
    _needs_ends(case)
    start, end = ([round(float(each), 9) for each in point] for point in ends_of(case.configs[0]))
    keys = [f"trajectory.start={_text(end)}", f"trajectory.goal={_text(start)}"]
    return _all(case, "the reversed direction", keys)


def _velocity(case: Case, value: Value) -> SidesChange:
    _skip_same(case, "noise.velocity", value)
    words = {"exact": "exact velocities", "finite_difference": "velocities by finite difference"}
    return _all(case, words.get(str(value), f"velocities by {value}"), [f"noise.velocity={value}"])


def _noise_kind(case: Case, value: Value) -> SidesChange:
    _skip_same(case, "noise.distribution", value)
    _needs_noise(case)
    factors = {("uniform", "gaussian"): 3.0**-0.5, ("gaussian", "uniform"): 3.0**0.5}
    old = str(case.values("noise.distribution")[0])
    if (old, value) not in factors:
        raise NotApplicableError(f"noise.distribution is {old}")
    same = _scaled(case, "noise.position", factors[old, str(value)])
    return SidesChange(f"{value} noise of the same variance", [[f"noise.distribution={value}", *own] for own in same])


def _duration(case: Case, value: Value) -> SidesChange:
    new = _scaled(case, "trajectory.duration", float(value))
    durations = case.values("trajectory.duration")
    for own, whole, motion in zip(new, case.values("duration"), durations, strict=True):
        if whole is not None:
            own.append(f"duration={_text(whole + (float(value) - 1.0) * min(whole, motion))}")  # of what is simulated
    one = len(set(durations)) == 1
    label = (
        f"a motion of {number(float(value) * float(durations[0]))} s"
        if one
        else f"{number(float(value))} times the duration"
    )
    return SidesChange(label, new)


def _noise(case: Case, value: Value) -> SidesChange:
    _needs_noise(case)
    return SidesChange(f"noise times {number(float(value))}", _scaled(case, "noise.position", float(value)))


def _torque_limit(case: Case, value: Value) -> SidesChange:
    limits = case.values("torque_limits.max")
    if value == "own":
        own = case.values("robot.torque_limit")
        if None in own or own == limits:
            raise NotApplicableError("the robot states no own torque limit" if None in own else "")
        label = f"the arm's own torque limit of {_amount(own[0], 'N m')}"
        return SidesChange(label, [[f"torque_limits.max={_text(each)}"] for each in own])
    if None not in limits:
        label = f"{number(float(value))} of the torque limit"
        return SidesChange(label, _scaled(case, "torque_limits.max", float(value)))
    if not case.peak > 0.0:
        raise NotApplicableError("the largest torque is unknown")
    limit = float(f"{float(value) * case.peak:.4g}")
    label = f"a torque limit of {number(limit)} N m ({number(float(value), 2)} of the peak)"
    return _all(case, label, [f"torque_limits.max={_text(limit)}"])


def _payload(case: Case, value: Value) -> SidesChange:
    if None in case.values("mismatch.payload") or None in case.values("robot.payload.mass"):
        raise NotApplicableError("the robot or the model error has no payload")
    mass = float(f"{float(value) * case.configs[0].arm.model.mass:.3g}")
    changes: list[list[str]] = []
    for carried, known in zip(case.values("robot.payload.mass"), case.values("mismatch.payload"), strict=True):
        changes.append([f"robot.payload.mass={_text(carried + mass)}", f"mismatch.payload={_text(known - mass)}"])
    return SidesChange(f"an unknown payload of {number(mass)} kg", changes)


def _friction(case: Case, value: Value) -> SidesChange:
    if not all(config.takes_torques for config in case.configs):
        raise NotApplicableError("the plant has no friction")
    found = case.values("plant.friction.coulomb")
    if any(found):
        raise NotApplicableError("the arm has friction already")
    if not case.peak > 0.0:
        raise NotApplicableError("the largest torque is unknown")
    level = float(f"{float(value) * case.peak:.3g}")
    label = f"dry friction of {number(level)} N m"
    return _all(case, label, [f"plant.friction.coulomb={_text(level)}"])


def _delay(case: Case, value: Value) -> SidesChange:
    if any(isinstance(known, Mapping) or known is None for known in case.values("plant.computation.delay")):
        raise NotApplicableError("the plant has no delay, or one for each stage")
    changes = [[f"plant.computation.delay={known + int(value)}"] for known in case.values("plant.computation.delay")]
    tick = case.configs[0].timing.tick
    return SidesChange(f"{number(1e3 * int(value) * tick)} ms more delay", changes)


def _period(case: Case, value: Value) -> SidesChange:
    new = _scaled(case, "controller.period", float(value))
    period = _times(case.values("controller.period")[0], float(value))
    return SidesChange(f"a control period of {_amount(period, 's')}", new)


def _model_error(case: Case, value: Value) -> SidesChange:
    known = case.values("mismatch.spread")
    if None in known:
        raise NotApplicableError("the model error has no spread")
    if max(known) >= float(value):
        raise NotApplicableError("the masses are drawn as widely already")
    return _all(
        case, f"masses drawn within {number(100.0 * float(value))} %", [f"mismatch.spread={_text(float(value))}"]
    )


def _gain(case: Case, value: Value) -> SidesChange:
    return SidesChange(
        f"{number(float(value))} times the main gain", _scaled(case, "controller.natural_frequency", value)
    )


def _gain_of(place: int) -> Callable[[Case, Value], SidesChange]:
    def change(case: Case, value: Value) -> SidesChange:
        scaled = _scaled(case, "controller.natural_frequency", value)
        label = f"{number(float(value))} times the main gain of only {case.sides[place].name}"
        return SidesChange(label, [own if side == place else [] for side, own in enumerate(scaled)])

    return change


def _period_step(case: Case) -> float:
    tick = case.configs[0].timing
    return tick.step / tick.tick


FAMILIES: Mapping[str, Sequence[Family]] = {
    "engine": [Family("numbers", _engine)],
    "step": [Family("numbers", _step)],
    "goal": [Family("equivalent", _goal)],
    "direction": [Family("equivalent", _direction)],
    "velocity": [Family("equivalent", _velocity)],
    "noise_kind": [Family("equivalent", _noise_kind)],
    "duration": [Family("conditions", _duration, "trajectory.duration", 1.0)],
    "noise": [Family("conditions", _noise, "noise.position", 1.0)],
    "torque_limit": [Family("conditions", _torque_limit, "torque_limits.max", 1.0)],
    "payload": [Family("conditions", _payload, "robot.payload.mass", 0.0)],
    "friction": [Family("conditions", _friction, "plant.friction.coulomb", 0.0)],
    "delay": [Family("conditions", _delay, "plant.computation.delay", 0.0, lambda _: 1.0)],
    "period": [Family("conditions", _period, "controller.period", 1.0, _period_step)],
    "model_error": [Family("conditions", _model_error, "mismatch.spread", 0.0)],
    "gain": [Family("conditions", _gain, "controller.natural_frequency", 1.0)],
    "gain_of_one": [Family("fairness", _gain_of(place), "controller.natural_frequency", 1.0) for place in (0, 1)],
}
"""The families by name; a family of one side has an entry for each side."""


def family_of(variation: Variation) -> Family | None:
    """Return the family of a variation; None for a key of the user's."""
    found = FAMILIES.get(variation.family, ())
    return found[variation.place] if found else None


def _all(case: Case, label: str, overrides: Sequence[str]) -> SidesChange:
    return SidesChange(label, [list(overrides) for _ in case.configs])


def _scaled(case: Case, key: str, factor: Value) -> list[list[str]]:
    """Return the overrides that scale a number, a list or the values of stages in each config."""
    values = case.values(key)
    if None in values:
        raise NotApplicableError(f"{key} is not set")
    return [list(_scaled_texts(key, value, float(factor))) for value in values]


def _scaled_texts(key: str, value: Any, factor: float) -> Iterator[str]:
    if isinstance(value, Mapping):
        yield from chain.from_iterable(_scaled_texts(f"{key}.{name}", each, factor) for name, each in value.items())
    else:
        yield f"{key}={_text(_times(value, factor))}"


def _times(value: Any, factor: float) -> Any:
    if isinstance(value, Mapping):
        return {name: _times(each, factor) for name, each in value.items()}
    if isinstance(value, list):
        return [_times(each, factor) for each in value]
    return float(f"{value * factor:.12g}")


def _amount(value: Any, unit: str) -> str:
    return f"{number(value)} {unit}" if isinstance(value, int | float) else f"{_text(value)} {unit}"


def _text(value: Any) -> str:
    return override_value(value)


def _skip_same(case: Case, key: str, value: Value) -> None:
    found = case.values(key)
    if None in found:
        raise NotApplicableError(f"{key} is not set")
    if set(found) == {value}:
        raise NotApplicableError("")


def _needs_noise(case: Case) -> None:
    for value in case.values("noise.position"):
        leaves = list(value.values()) if isinstance(value, Mapping) else value if isinstance(value, list) else [value]
        if not any(leaves):
            raise NotApplicableError("noise.position is 0")


def _needs_ends(case: Case) -> None:
    resolved = [config.resolved["trajectory"] for config in case.configs]
    if any(not isinstance(each, Mapping) or "goal" not in each or "start" not in each for each in resolved):
        raise NotApplicableError("the motion has no start and goal of the tip")
    first = case.configs[0].resolved
    if any(own[group] != first[group] for own in (config.resolved for config in case.configs) for group in _MOTION):
        raise NotApplicableError("the motions or arms of the sides differ")
