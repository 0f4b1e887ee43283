"""What one closed-loop run leaves behind: every signal at every control tick."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Failure:
    """Why and where a closed loop left the domain of its equations.

    Attributes:
        reason: What happened.
        time: When, in s.
        joint: Name of the joint that left first, or None where no single one did.
    """

    reason: str
    time: float
    joint: str | None = None


@dataclass(frozen=True)
class ContactSignals:
    """Wrenches of one run, a row of force in N and moment in N m for each control tick, shapes (T, 6).

    Attributes:
        external: Of the world on the tip, moment about the tip, along the base's axes.
        felt: The same as the controller believes it; zero where none feels.
        reading: Of the wrist's sensor, about its origin, along its axes.
        load: Of world and tool on the flange, about its origin, along its axes: what the sensor is to read.
        reaction: The same as PyBullet computes it in the joint, for comparison; zero on other plants.
    """

    external: FloatArray
    felt: FloatArray
    reading: FloatArray
    load: FloatArray
    reaction: FloatArray


@dataclass(frozen=True)
class Trace:
    """Signals of one run, a row for each control tick from t = 0 to the end, true values unless said.

    Attributes:
        t: Times, shape (T,), in s.
        q: Joint positions, shape (T, nq), in rad.
        dq: Joint velocities, shape (T, nq), in rad/s.
        tau: Torques after the limit, held until the next row, shape (T, nq), in N m.
        end_points: End point of each stage in the base frame, shape (stages, T, 3), in m; the last is the tip.
        offsets: Offset of the tip at home from each stage's end point, shape (stages, 3), in m; the last is zero.
        stage_names: Names of the stages.
        desired: Desired tip position, velocity, acceleration, shape (T, 3, 3): rows in m, m/s, m/s^2.
        limits: Torque limit of each joint, shape (nq,), in N m; infinite where there is none.
        joint_names: Names of the joints.
        joint_units: Unit of each joint's position: rad where it turns, m where it slides. There speeds are in m/s and
            torques are forces, in N.
        tick_seconds: Wall-clock time that each tick took, shape (T - 1,), in s.
        q_command: Joint positions commanded, held until the next row, shape (T, nq), in rad; None under torques.
        contact: What the tip felt, by what is meant; None where there was nothing to feel.
        failure: Why the run ended early, or None.
    """

    t: FloatArray
    q: FloatArray
    dq: FloatArray
    tau: FloatArray
    end_points: FloatArray
    offsets: FloatArray
    stage_names: tuple[str, ...]
    desired: FloatArray
    limits: FloatArray
    joint_names: tuple[str, ...]
    joint_units: tuple[str, ...]
    tick_seconds: FloatArray
    q_command: FloatArray | None = None
    contact: ContactSignals | None = None
    failure: Failure | None = None

    @property
    def tip(self) -> FloatArray:
        """Tip positions in the base frame, shape (T, 3), in m."""
        tip: FloatArray = self.end_points[-1]
        return tip

    def at_stage(self, index: int) -> "Trace":
        """Return the trace with a stage's end point in the tip's place, and x_d less its home offset desired of it."""
        desired = self.desired.copy()
        desired[:, 0] -= self.offsets[index]
        return replace(self, end_points=self.end_points[index : index + 1], desired=desired)

    @property
    def error(self) -> FloatArray:
        """Tip error, desired minus actual, shape (T, 3), in m."""
        difference: FloatArray = self.desired[:, 0] - self.tip
        return difference
