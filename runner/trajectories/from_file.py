"""Tip or joint motion from a data file."""

from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, PositiveFloat, ValidationInfo, field_validator

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.robots.robot import Robot
from runner.schema.model import StrictModel
from runner.schema.units import Seconds
from runner.trajectories.interpolation import Interpolated, Interpolation, interpolate
from runner.trajectories.joint_motion import JointMotion
from runner.trajectories.nearest import distance_to_curve
from runner.trajectories.table import parts_of, wrong_columns
from runner.trajectories.trajectory import TrackedMotion, Trajectory


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

    def motion(self) -> Interpolated:
        """Return the interpolated motion of the tip or of the joints."""
        columns = self.columns or {}
        rows = [[columns[name] for name in part] for part in parts_of(list(columns))]  # (orders, k, N)
        return interpolate(np.array(columns["t"]), np.moveaxis(np.array(rows), -1, 0), self.interpolation)


@dataclass(frozen=True)
class TipMotion(TrackedMotion):
    """Motion of the tip through the rows of a file; see Trajectory for the attributes.

    Attributes:
        rows: The interpolated motion, in m.
    """

    rows: Interpolated

    @property
    def start(self) -> FloatArray:
        """Tip position in the first row."""
        start: FloatArray = self.rows.sample(np.zeros(1))[0, 0]
        return start

    @property
    def goal(self) -> FloatArray:
        """Tip position in the last row."""
        goal: FloatArray = self.rows.sample(self.rows.times[-1:])[0, 0]
        return goal

    @property
    def duration(self) -> float:
        """Time t_f of the last row, in s."""
        return self.rows.duration

    def sample(self, times: FloatArray) -> FloatArray:
        """Return the motion; after t_f it rests at the last row."""
        return self.rows.sample(times)

    def distance_to_path(self, points: FloatArray) -> FloatArray:
        """Return the distance to the curve through the rows."""
        even = np.linspace(0.0, self.duration, self.rows.samples + 1)
        return distance_to_curve(points, self.sample, np.union1d(even, self.rows.times))


class JointRows(Interpolated):
    """Motion of the joints through the rows of a file, in rad; see JointMotion."""

    def sample_joints(self, times: FloatArray) -> FloatArray:
        """Return the motion; after t_f it rests at the last row."""
        return self.sample(times)


CONFIG = FromFileConfig


def build(config: FromFileConfig, _: FloatArray) -> Trajectory:
    """Build the motion of the tip from a file; it starts at the first row of the file."""
    return TipMotion(config.motion())


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
    motion = config.motion()
    return JointRows(motion.times, motion.orders)
