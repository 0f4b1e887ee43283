"""Tip or joint motion from a text or Parquet file, whose error messages contain the line."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import chain, pairwise
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, PositiveFloat, ValidationInfo, field_validator

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError, TableError
from runner.base.limits import TABLE, TABLE_NUMBERS, ExcessError
from runner.base.sanitize import quoted
from runner.base.tables import first_problems, read_table
from runner.robots.robot import Robot
from runner.schema.model import StrictModel
from runner.schema.units import Seconds
from runner.trajectories.joint_motion import JointMotion
from runner.trajectories.splines import Interpolation, Spline, interpolate
from runner.trajectories.trajectory import Trajectory

Columns = Mapping[str, Sequence[float]]

ALLOWED = (
    "t,x,y,z or t,q1,q2,... with a column for each joint; velocities (vx,vy,vz or dq1,dq2,...) and then accelerations "
    "(ax,ay,az or ddq1,ddq2,...) may follow"
)
_ROUNDING = 1e-9  # of the largest speed


def read_motion(path: Path) -> dict[str, list[float]]:
    """Return the columns of a data file, without unit conversion.

    Args:
        path: The file; see runner.base.tables.

    Raises:
        ConfigError: if the file cannot be read, is too large, or does not describe a motion; the message contains the
            lines.
    """

    def check(names: Sequence[str]) -> Sequence[str]:
        if not parts_of(names):
            raise _refused(path, f"has the columns {quoted(','.join(names))}; allowed: {ALLOWED}")
        return names

    try:
        table = read_table(path, check, TABLE)
    except TableError as error:
        raise _refused(path, *error.problems) from error
    except (OSError, ExcessError) as error:
        raise _refused(path, f"cannot be read: {error}") from error
    gaps = [
        (row, name) for name, column in table.columns.items() for row in np.flatnonzero(~np.isfinite(column)).tolist()
    ]
    problems = [
        *table.notes,
        *(["has a line of units; allowed: columns in s, m and rad without one"] if table.units else []),
        *(f"{table.place(row)}: {name} is missing; allowed: a finite number" for row, name in gaps),
    ]
    columns = {name: column.tolist() for name, column in table.columns.items()}
    if problems := problems or list(wrong_columns(columns, table.place)):
        raise _refused(path, *first_problems(problems, len(problems)))
    return columns


def parts_of(names: Sequence[str]) -> list[list[str]]:
    """Return the column names in groups: positions, then velocities and accelerations if they exist.

    The list is empty if the names do not describe a motion; see ALLOWED.
    """
    if list(names[:1]) != ["t"]:
        return []
    rest, tip = list(names[1:]), names[1:2] == ["x"]
    count = 3 if tip else sum(name.startswith("q") for name in rest)
    stems = ("", "v", "a") if tip else ("q", "dq", "ddq")
    places = "xyz" if tip else [str(joint + 1) for joint in range(count)]
    parts = [[f"{stem}{place}" for place in places] for stem in stems]
    found = len(rest) // count if count else 0
    return parts[:found] if 1 <= found <= len(stems) and rest == list(chain(*parts[:found])) else []


def wrong_columns(columns: Columns, place: Callable[[int], str]) -> Iterator[str]:
    """Yield a message for each problem in the columns of a motion from rest to rest.

    Args:
        columns: The columns.
        place: Function of a row's index from 0; returns the row's label in messages.
    """
    parts = parts_of(list(columns))
    if not parts:
        yield f"has the columns {quoted(','.join(columns))}; allowed: {ALLOWED}"
        return
    t = columns["t"]
    if len({len(column) for column in columns.values()}) > 1:
        yield "has columns of unequal lengths"
        return
    if len(t) < 3:
        yield f"has {len(t)} rows; a motion needs 3 or more"
        return
    if excess := TABLE_NUMBERS.excess(len(t) * len(columns)):
        yield excess
        return
    if t[0] != 0.0:
        yield f"{place(0)}: t is {t[0]:g} s; the first must be 0"
    for row, (before, now) in enumerate(pairwise(t), start=1):
        if now <= before:
            yield f"{place(row)}: t is {now:g} s after {before:g} s; time must run forward"
    for name in parts[1] if len(parts) > 1 else ():
        largest = max(map(abs, columns[name]))
        for row in (0, len(t) - 1):
            if abs(columns[name][row]) > _ROUNDING * largest:
                yield f"{place(row)}: {name} is {columns[name][row]:g}; the motion must start and end at rest, with 0"


def _refused(path: Path, *problems: str) -> ConfigError:
    return ConfigError([f"trajectory.file: {path.name}: {problem}" for problem in problems])


def _check_interpolation(value: Any) -> Any:
    if value == "linear":
        raise ValueError("jumps in velocity at every row, an acceleration without bound; allowed: spline, hermite")
    return value


class FromFileConfig(StrictModel):
    """Config of a motion from a data file.

    Attributes:
        kind: Name of the kind in the registry.
        file: CSV or Parquet file: an absolute path, or a path in one of your config folders or in the working folder.
        interpolation: Interpolation between rows: "spline" is the cubic spline through the positions, at rest at both
            ends; "hermite" also uses the velocities of the file, and its accelerations if given.
        columns: Values of the file by column, in s, m, m/s and m/s^2, or rad, rad/s and rad/s^2. The runner reads them
            when it composes the config, so that a stored run does not need the file.
        duration: t_f, the last time of the file, in s; None takes it from the file.
    """

    kind: Literal["from_file"]
    file: str | None
    interpolation: Annotated[Interpolation, BeforeValidator(_check_interpolation)]
    columns: Seconds[dict[str, list[float]] | None]
    duration: Seconds[PositiveFloat | None]

    @field_validator("columns")
    @classmethod
    def _check_columns(cls, value: dict[str, list[float]] | None, info: ValidationInfo) -> dict[str, list[float]]:
        if value is None:
            raise ValueError("missing; name a CSV or Parquet file, as in trajectory.file=motion.csv")
        problems = list(wrong_columns(value, lambda row: f"row {row + 1}"))
        orders = len(parts_of(list(value)))
        kind = info.data.get("interpolation")
        if not problems and kind == "spline" and orders > 1:
            problems.append("the file has velocities, which interpolation=spline would not take; take hermite")
        if not problems and kind == "hermite" and orders == 1:
            problems.append("the file has no velocities, which interpolation=hermite needs; take spline")
        if problems:
            raise ValueError(problems[0])
        return value

    @field_validator("duration")
    @classmethod
    def _check_duration(cls, value: float | None, info: ValidationInfo) -> float | None:
        columns = info.data.get("columns")
        if columns and value not in (None, columns["t"][-1]):
            raise ValueError(f"the file lasts {columns['t'][-1]:g} s; allowed: null")
        return value

    def motion(self) -> Spline:
        """Return the interpolated motion of the tip or of the joints."""
        columns = self.columns or {}
        rows = [[columns[name] for name in part] for part in parts_of(list(columns))]  # (orders, k, N)
        return interpolate(np.array(columns["t"]), np.moveaxis(np.array(rows), -1, 0), self.interpolation)


CONFIG = FromFileConfig


def build(config: FromFileConfig, _: FloatArray) -> Trajectory:
    """Build the motion of the tip from a file; it starts at the first row of the file."""
    return config.motion()


def joint_motion(config: FromFileConfig, robot: Robot) -> JointMotion | None:
    """Build the motion of the joints from a file; return None if the file contains a motion of the tip.

    Raises:
        ConfigError: if the number of joints differs from that of the robot.
    """
    (positions, *_) = parts_of(list(config.columns or {}))
    if positions == ["x", "y", "z"]:
        return None
    names = robot.model.joint_names
    if len(positions) != len(names):
        raise ConfigError(
            f"trajectory.file: has {len(positions)} joints, q1 to q{len(positions)}; the robot has {len(names)}: "
            f"{', '.join(names)}"
        )
    return config.motion()
