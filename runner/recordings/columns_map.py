"""Column map of a recording: the signal and unit of each column."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Literal, NamedTuple, cast

import numpy as np
from pydantic import Field, FiniteFloat, NonNegativeFloat, NonNegativeInt, PositiveFloat, model_validator

from runner.base.arrays import FloatArray
from runner.base.data_file import read_data
from runner.base.errors import RunnerError, nearest
from runner.base.sanitize import quoted
from runner.robots.model import RobotModel
from runner.schema.model import StrictModel, absurd
from runner.schema.units import WRITTEN
from runner.schema.values import Vector

AMPERE, PERCENT = "A", "%"
SignalKind = Literal["position", "velocity", "acceleration", "torque", "tip", "reference"]
MOTION = ("joint", "velocity", "acceleration", "reference", "torque")
"""Keys of a column that name a joint."""
_OF_JOINTS: tuple[SignalKind, ...] = ("velocity", "acceleration", "reference", "torque")
Holds = Literal["torque", "without_gravity", "commanded"]
Side = Literal["motor", "link"]


class Signal(NamedTuple):
    """A signal of an arm.

    Attributes:
        kind: The position, velocity, acceleration, commanded position or torque of a joint, or a coordinate of the tip
            in the base frame.
        of: Name of the joint; x, y or z of the tip.
    """

    kind: SignalKind
    of: str

    @property
    def words(self) -> str:
        """Name of the column."""
        if self.kind == "tip":
            return f"tip {self.of}"
        return f"{'commanded position' if self.kind == 'reference' else self.kind} of {self.of}"


def stacked(signals: Mapping[Signal, FloatArray], wanted: Sequence[Signal]) -> FloatArray | None:
    """Return some signals as columns, shape (N, n); None if one is missing."""
    found = [signals[signal] for signal in wanted if signal in signals]
    return np.column_stack(found) if len(found) == len(wanted) else None


class TimeColumn(StrictModel):
    """Column of the time.

    Attributes:
        column: Name of the column.
        unit: Its unit, such as s or ms.
    """

    column: str
    unit: str


class MappedColumn(StrictModel):
    """Signal of a column: a joint, a torque or a coordinate of the tip.

    The signal is sign (value - zero) times its unit, after jumps by `wrap` are removed.

    Attributes:
        joint: The joint whose position it holds.
        velocity: The joint whose speed it holds.
        acceleration: The joint whose acceleration it holds.
        reference: The joint whose commanded position it holds.
        torque: The joint whose torque it holds, or the current of whose motor.
        tip: The coordinate of the tip in the base frame.
        unit: Its unit, such as deg, N m or mm; A for a current; % of `scale`.
        constant: Torque by current, in N m/A (N/A for a prismatic joint): the motor's constant times its gear ratio,
            below zero where a current drives the joint backwards.
        scale: With unit %: the signal at 100 %, in N m, N, rad or m.
        sign: -1 if the column grows where the signal falls.
        zero: The column's value where the signal is zero, in its unit.
        wrap: Range after which the column starts again, in its unit. None: a turn, where a joint jumps by one.
        coupling: Signals of other joints that are added, times a factor each: joint 3 of a FANUC is J3 + J2.
        holds: Of a torque: torque, measured with gravity; without_gravity, as a controller that compensates gravity
            reports it; commanded, which acts from its row to the next one unless the map says torque: instant.
        side: Of a torque: motor, or link where the sensor is behind the gears, and so feels neither the inertia of the
            rotor nor the friction of the gears.
    """

    joint: str | None = None
    velocity: str | None = None
    acceleration: str | None = None
    reference: str | None = None
    torque: str | None = None
    tip: Literal["x", "y", "z"] | None = None
    unit: str
    constant: FiniteFloat | None = None
    scale: PositiveFloat | None = None
    sign: Literal[1, -1] = 1
    zero: FiniteFloat = 0.0
    wrap: PositiveFloat | None = None
    coupling: dict[str, FiniteFloat] = Field(default_factory=dict)
    holds: Holds | None = None
    side: Side | None = None

    @model_validator(mode="after")
    def _check(self) -> "MappedColumn":
        given = [name for name in (*MOTION, "tip") if getattr(self, name) is not None]
        if len(given) != 1:
            found = f"found {' and '.join(given)}" if given else "found none of them"
            raise ValueError(f"must say one of {', '.join(MOTION)} and tip; {found}")
        if (self.unit == AMPERE) != (self.constant is not None):
            raise ValueError(
                "a current needs constant, in N m/A, and nothing else takes it: unit: A, constant: 1.6; all masses and "
                "friction scale with it"
            )
        if (self.unit == PERCENT) != (self.scale is not None):
            raise ValueError(
                'a per cent needs scale, its value at 100 %, and nothing else takes it: unit: "%", scale: 26'
            )
        if self.constant is not None and self.torque is None:
            raise ValueError("a current is that of a motor: say by torque whose")
        if self.constant == 0.0:
            raise ValueError("constant: must not be 0; it is the torque of one ampere, below 0 where it turns the sign")
        for key in ("holds", "side"):
            if self.torque is None and getattr(self, key) is not None:
                raise ValueError(f"{key}: is for torques; leave it out")
        if self.wrap is not None and self.joint is None and self.reference is None:
            raise ValueError("wrap: is for positions of joints; leave it out")
        if self.coupling and self.tip is not None:
            raise ValueError("coupling: is for joints; leave it out")
        return self

    @property
    def of(self) -> str | None:
        """The joint that it is of; None for a coordinate of the tip."""
        return next((name for key in MOTION if (name := getattr(self, key)) is not None), None)

    @property
    def signal(self) -> Signal:
        """The signal that it holds."""
        if self.joint is not None:
            return Signal("position", self.joint)
        for kind in _OF_JOINTS:
            if (joint := getattr(self, kind)) is not None:
                return Signal(kind, joint)
        return Signal("tip", str(self.tip))


class FixedPayload(StrictModel):
    """A payload that the arm carried: a point mass fixed at the tip.

    Attributes:
        mass: Its mass, in kg.
        position: Its position in the frame of the tip, in m.
    """

    mass: NonNegativeFloat
    position: Vector = Field(default_factory=lambda: [0.0, 0.0, 0.0])

    def fixed_on(self, model: RobotModel) -> RobotModel:
        """Return an arm with this payload."""
        return model.with_payload(self.mass, np.array(self.position))

    @property
    def overrides(self) -> tuple[str, ...]:
        """Overrides of a run with this payload."""
        place = ",".join(f"{each!r}" for each in self.position)
        return (f"robot.payload.mass={self.mass!r}", f"robot.payload.position=[{place}]")


class ColumnsMap(StrictModel):
    """Signals in the columns of a recording.

    Attributes:
        time: Column of the time; None if rows have an even rate.
        rate: Rows in a second, in Hz; if there is a column of time, both must agree.
        columns: What each column holds, by its name; columns that are not named are not read.
        torque: held if a torque acts from its row to the next one, as a controller commands it: it is centred, half a
            row later; instant if it was measured at the time of its row; None for instant of sensors on the link side
            that measure, else held.
        topic: Of a ROS bag: the topic of its joint states; None if it has only one.
        episode: Of a LeRobot data set: the episode; None for its longest.
        warmth: Temperature of the arm in this log, cold or warm; None if it is not known.
        payload: What the arm carried in this log, besides what its model holds; None for nothing.
    """

    time: TimeColumn | None = None
    rate: PositiveFloat | None = None
    columns: dict[str, MappedColumn] = Field(min_length=1)
    torque: Literal["held", "instant"] | None = None
    topic: str | None = None
    episode: NonNegativeInt | None = None
    warmth: Literal["cold", "warm"] | None = None
    payload: FixedPayload | None = None

    @model_validator(mode="after")
    def _check(self) -> "ColumnsMap":
        if self.time is None and self.rate is None:
            raise ValueError("needs time, as in time: {column: t, unit: s}, or rate, in Hz, as in rate: 500.0")
        first: dict[Signal, str] = {}
        for name, column in self.columns.items():
            before = first.setdefault(column.signal, name)
            if before != name:
                raise ValueError(f"columns: {before} and {name} both hold the {column.signal.words}; leave one out")
        for key in ("holds", "side"):
            said = {getattr(column, key) for column in self.columns.values() if column.torque is not None}
            if len(said) > 1:
                raise ValueError(f"columns: {key} must be the same for all torques; leave out those that differ")
        for name, column in self.columns.items():
            for joint in column.coupling:
                if (column.signal.kind, joint) not in first or joint == column.of:
                    raise ValueError(
                        f"columns.{name}.coupling: no other column holds the {column.signal.kind} of {joint}"
                    )
        return self

    def _of_torques(self, key: str) -> str | None:
        return next((getattr(column, key) for column in self.columns.values() if column.torque is not None), None)

    @property
    def holds(self) -> Holds:
        """What the columns of torques hold."""
        return cast("Holds", self._of_torques("holds") or "torque")

    @property
    def side(self) -> Side:
        """The side of the gears on which torques are measured."""
        return cast("Side", self._of_torques("side") or "motor")

    @property
    def held(self) -> bool:
        """Whether a torque acts from its row to the next one."""
        usual = "instant" if self.side == "link" and self.holds != "commanded" else "held"
        return (self.torque or usual) == "held"

    def loaded(self, model: RobotModel) -> RobotModel:
        """Return an arm with the payload of this log."""
        return model if self.payload is None else self.payload.fixed_on(model)


class Factor(NamedTuple):
    """Conversion of a column's numbers to SI units.

    Attributes:
        factor: SI units in one of the column's.
        unit: The SI unit.
    """

    factor: float
    unit: str


def read_map(path: Path, joints: Sequence[str], units: Sequence[str]) -> tuple[ColumnsMap, dict[str, Factor]]:
    """Return the column map of a file, and the factor of each column to SI with its sign.

    Args:
        path: The file, YAML.
        joints: Names of the robot's joints.
        units: Unit of each joint's position: rad, or m for a prismatic joint.

    Raises:
        RunnerError: if it cannot be read, names a joint that the robot does not have, or a unit that does not fit.
    """
    found = read_data(path, ColumnsMap)
    try:
        return found, factors_of(found, joints, units)
    except RunnerError as error:
        raise RunnerError(f"{path}: {error}") from None


def factors_of(found: ColumnsMap, joints: Sequence[str], units: Sequence[str]) -> dict[str, Factor]:
    """Return the factor of each column of a map to SI; see read_map."""
    problems = [*_unknown_joints(found, joints), *absurd("", found.model_dump())]
    factors: dict[str, Factor] = {}
    prismatic = {joint: unit == "m" for joint, unit in zip(joints, units, strict=True)}
    wanted = {} if found.time is None else {found.time.column: (found.time.unit, "s", "time")}
    wanted |= {
        name: (column.unit, _si_unit(column.signal, prismatic), f"columns.{name}")
        for name, column in found.columns.items()
        if column.unit not in (AMPERE, PERCENT)
    }
    for name, (unit, own, key) in wanted.items():
        factor = WRITTEN[own].get(unit)
        if factor is None:
            near = nearest(unit, WRITTEN[own])
            problems.append(f"{key}.unit: must be one of {', '.join(WRITTEN[own])}; found {quoted(unit)}{near}")
        else:
            factors[name] = Factor(float(factor), own)
    for name, column in found.columns.items():
        own = _si_unit(column.signal, prismatic)
        if column.constant is not None:
            factors[name] = Factor(column.constant, own)
        if column.scale is not None:
            factors[name] = Factor(column.scale / 100.0, own)
        if name in factors:
            factors[name] = Factor(column.sign * factors[name].factor, own)
    if problems:
        raise RunnerError("; ".join(problems))
    return factors


def _unknown_joints(found: ColumnsMap, joints: Sequence[str]) -> Iterator[str]:
    for name, column in found.columns.items():
        for joint in [joint for joint in (column.of, *column.coupling) if joint is not None and joint not in joints]:
            yield (
                f"columns.{name}: the robot has no joint {quoted(joint)}{nearest(joint, joints)}; joints: "
                f"{', '.join(joints)}"
            )


_LENGTHS = {"position": "", "reference": "", "velocity": "/s", "acceleration": "/s^2"}


def _si_unit(signal: Signal, prismatic: dict[str, bool]) -> str:
    if signal.kind == "tip":
        return "m"
    if signal.kind in _LENGTHS:
        return f"{'m' if prismatic.get(signal.of) else 'rad'}{_LENGTHS[signal.kind]}"
    return "N" if prismatic.get(signal.of) else "N m"


_ALIKE = 0.8  # correlation about zero, from which on a signal is a multiple of the run's
_NEAR = 1.5  # factor within which a unit explains the multiple
_SAME = 4.0  # factor within which a signal may differ for other reasons


def other_units(
    recorded: Mapping[Signal, FloatArray],
    simulated: Mapping[Signal, FloatArray],
    columns: Mapping[Signal, str],
    units: Mapping[str, Factor],
) -> Iterator[str]:
    """Yield a question for each column that would fit the run in another unit.

    Args:
        recorded: Signals of the recording, shape (T,), in SI units.
        simulated: The same of the run, at the same times.
        columns: The column of each signal.
        units: What made each column SI.
    """
    for signal, values in recorded.items():
        run = simulated[signal]
        size, run_size = float(np.linalg.norm(values)), float(np.linalg.norm(run))
        if min(size, run_size) == 0.0 or abs(float(values @ run)) < _ALIKE * size * run_size:
            continue
        multiple = size / run_size
        if 1.0 / _SAME < multiple < _SAME:
            continue
        factor, si = units[columns[signal]]
        wanted = abs(factor) / multiple
        fitting = [
            (abs(np.log(float(other) / wanted)), name)
            for name, other in WRITTEN[si].items()
            if 1.0 / _NEAR < float(other) / wanted < _NEAR
        ]
        times = f"{multiple:.4g} times" if multiple > 1.0 else f"1/{1.0 / multiple:.4g} of"
        if fitting:
            yield (
                f"columns.{columns[signal]}: the {signal.words} is {times} the run's; the column looks like "
                f"{min(fitting)[1]}: say unit: {min(fitting)[1]}"
            )
