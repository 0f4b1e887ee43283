"""Result of an identification: parameters with intervals, accuracy on unseen torques, and what the logs do not tell."""

import dataclasses
import hashlib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from runner.base.atomic import refuse_links, write_atomically
from runner.base.errors import RunnerError
from runner.store.kinds import KINDS
from runner.store.seal import DamagedError, read_json, sealed_json

_FILE = KINDS["identification"].files[0]
_REMEDY = "the identification's command writes it again"


@dataclass(frozen=True)
class IdentifiedParameter:
    """A parameter of the torques that the logs determine.

    Attributes:
        name: A sum of masses, first moments and inertias, or a term of the friction of a joint.
        unit: Its unit.
        value: Its value.
        half: Half-width of its 95 % interval.
        white: The same if residuals were not correlated, as most tools take them.
        file: The value of the robot's file; of a torque constant that of the column map; None for friction.
        second: The value of ordinary least squares.
        differs: True if both methods differ as chance makes them in less than 1 % of cases; `half` contains it.
        spread: True if the logs differ as chance makes them in less than 0.1 % of cases; `half` contains it.
        stands_for: Names of parameters that the logs cannot tell from this one.
        prior_share: Share of the robot's file in the value, 0 to 1; None for friction and without a prior.
    """

    name: str
    unit: str
    value: float
    half: float
    white: float
    file: float | None
    second: float
    differs: bool
    spread: bool
    stands_for: Sequence[str] = ()
    prior_share: float | None = None


@dataclass(frozen=True)
class Untold:
    """A parameter that the logs do not determine.

    Attributes:
        name: Its name.
        reason: Why.
        motion: A motion that would determine it.
    """

    name: str
    reason: str
    motion: str


@dataclass(frozen=True)
class JointAccuracy:
    """Accuracy of the torques of a joint, and its residuals.

    Attributes:
        joint: Its name.
        unit: Unit of its position.
        held_out: Norm of the errors of unseen torques over that of the torques.
        file: The same of the model in the robot's file, without friction.
        rows: Rows of its torque in the fit.
        left_out: Share of its rows that are near standstill, and so not in the fit.
        outside: Share of the rows in the fit that count less, as far outside.
        time: Times of shown rows, in s; log by log.
        position: Positions in these, in rad.
        speed: Speeds, in rad/s.
        load: Torques of links, rotor and payload, in N m.
        residual: What the fit leaves over, in N m.
    """

    joint: str
    unit: str
    held_out: float
    file: float
    rows: int
    left_out: float
    outside: float
    time: Sequence[float]
    position: Sequence[float]
    speed: Sequence[float]
    load: Sequence[float]
    residual: Sequence[float]


@dataclass(frozen=True)
class Alternative:
    """A kind of friction or a cut-off that was tried.

    Attributes:
        kind: Kind of friction.
        frequency: Cut-off, in Hz.
        held_out: Norm of the errors of unseen torques over that of the torques.
        square: Mean weighted square of these errors, by which the choice is made.
        follows: What the residuals still follow, in words.
        chosen: True for the one that is reported.
    """

    kind: str
    frequency: float
    held_out: float
    square: float
    follows: Sequence[str]
    chosen: bool


@dataclass(frozen=True)
class LogFacts:
    """A log.

    Attributes:
        name: Name of its file.
        digest: SHA-256 of its content.
        rows: Number of its rows.
        duration: In s.
        period: Usual time between two rows, in s.
        warmth: Temperature of the arm, cold or warm; None if the map does not say it.
        notes: What was done to its rows, and what is unusual.
    """

    name: str
    digest: str
    rows: int
    duration: float
    period: float
    warmth: str | None
    notes: Sequence[str]


@dataclass(frozen=True)
class Identification:
    """An identification of an arm by its logs.

    Attributes:
        folder: Its folder.
        command: Command that makes it.
        robot: Name of the robot.
        urdf: Its file.
        side: Side of the gears on which torques are measured: motor or link.
        currents: Joints whose torques are currents times the constant of the column map.
        kind: Kind of friction.
        forced: True if the kind was given by the user.
        frequency: Cut-off on both sides of the equations, in Hz.
        parameters: What the logs determine.
        untold: What they do not.
        joints: Accuracy by joint.
        held_out: Norm of the errors of unseen torques over that of the torques, of all joints.
        file: The same of the model in the robot's file, without friction.
        alternatives: Kinds of friction and cut-offs with their held-out errors.
        logs: The logs.
        follows: What the residuals still follow, in words.
        payloads: Changes of the payload within logs, in words.
        delay: Delay of the torques, in s.
        delay_half: Half-width of its interval, in s; None if the logs do not tell the delay.
        block: Time within which residuals may be correlated, in s.
        rank: Number of determined parameters, without the delay.
        condition: Condition number of the equations.
        shapes: v_s of the friction of each joint, in rad/s; empty if the kind has none.
        bodies: Sentence on bodies with positive masses and inertias that have these values.
        prior: Width of the file's values as a share, if they were asked for as a prior.
        date: When it was made, ISO format.
    """

    folder: Path
    command: str
    robot: str
    urdf: str
    side: str
    currents: Sequence[str]
    kind: str
    forced: bool
    frequency: float
    parameters: Sequence[IdentifiedParameter]
    untold: Sequence[Untold]
    joints: Sequence[JointAccuracy]
    held_out: float
    file: float
    alternatives: Sequence[Alternative]
    logs: Sequence[LogFacts]
    follows: Sequence[str]
    payloads: Sequence[str]
    delay: float
    delay_half: float | None
    block: float
    rank: int
    condition: float
    shapes: Sequence[float] = field(default_factory=list)
    bodies: str = ""
    prior: float | None = None
    date: str = ""

    def write(self) -> None:
        """Write the result.

        Raises:
            RunnerError: if a number of it is not finite, so that it could not be read.
            StoreError: if a file cannot be written.
        """
        content = _plain(dataclasses.asdict(self) | {"folder": ""})
        try:
            _read(content)
        except ValidationError as error:
            raise RunnerError(
                f"identification: {_first_fault(error)}. Nothing is stored; needed: a log with more motion."
            ) from error
        refuse_links(self.folder.parent.parent, self.folder)
        write_atomically(self.folder / _FILE, sealed_json(content))


def _plain(value: Any) -> Any:
    """Return a value as JSON allows it: a number that is not finite is null."""
    if isinstance(value, dict):
        return {key: _plain(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def place_of(outputs: Path, said: Sequence[object]) -> Path:
    """Return the folder of an identification, named by all that it follows from."""
    return outputs / KINDS["identification"].folder / hashlib.sha256(repr(said).encode()).hexdigest()[:24]


def open_identification(folder: Path) -> Identification:
    """Open a stored identification.

    Raises:
        DamagedError: if the folder is not an identification, or is damaged.
    """
    path = folder / _FILE
    content = read_json(path, _REMEDY)
    known = {each.name: content[each.name] for each in dataclasses.fields(Identification) if each.name in content}
    try:
        return _read(known | {"folder": folder})
    except ValidationError as error:
        text = f"it does not describe an identification: {_first_fault(error)}"
        raise DamagedError(f"cannot read {path}: {text}; {_REMEDY}") from error


def _read(content: Mapping[str, Any]) -> Identification:
    return TypeAdapter(Identification).validate_python(content)


def _first_fault(error: ValidationError) -> str:
    first = error.errors()[0]
    return f"{'.'.join(map(str, first['loc']))}: {first['msg']}"
