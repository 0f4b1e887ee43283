"""Tip or joint motion from a data file."""

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, PositiveFloat, ValidationInfo, field_validator

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.robots.robot import Robot
from runner.schema.model import StrictModel
from runner.schema.units import Seconds
from runner.trajectories.joint_motion import JointMotion
from runner.trajectories.splines import Interpolation, Spline, interpolate
from runner.trajectories.table import parts_of, wrong_columns
from runner.trajectories.trajectory import Trajectory


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
