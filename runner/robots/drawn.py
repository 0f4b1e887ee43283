"""Nominal arms of several runs with other inertial parameters each, and arrays whose entries are arrays over runs."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import pin
from runner.robots.model import RobotModel


def over_runs(values: FloatArray) -> NDArray[Any]:
    """Return the numbers of several runs, shape (runs, ...), as an array of objects: an array over the runs for each.

    NumPy's operators work on it as on the numbers of one run. The result of a run does not depend on the other runs.
    """
    found = np.empty(values.shape[1:], dtype=object)
    for place in np.ndindex(found.shape):
        found[place] = np.ascontiguousarray(values[(slice(None), *place)])
    return found


def by_run(values: Iterable[Any]) -> FloatArray:
    """Return floats and arrays over runs as one array, shape (runs, k); shape (k,) if all of them are floats."""
    found: FloatArray = np.stack(np.broadcast_arrays(*values), axis=-1)
    return found


def each_run(compute: Callable[[FloatArray], FloatArray], values: NDArray[Any]) -> NDArray[Any]:
    """Return a function of numbers, which broadcasts over leading axes; of arrays over runs, for each run."""
    if values.dtype != object:
        return compute(values)
    return over_runs(compute(by_run(values.ravel()).reshape(-1, *values.shape)))


class DrawnModel(RobotModel):
    """Several arms that differ in the inertial parameters of their links only.

    Masses, the mass matrix and the gravity torque are arrays over the arms; see over_runs. Other dynamics are those of
    the common arm, which the control laws do not read when they are built.

    Args:
        common: Arm with the kinematics, the armature and the gravity of all arms.
        rows: Ten parameters of each moving body of each arm, shape (runs, nq, 10); see Arm.regressor.

    Attributes:
        common: As above.
        rows: As above.
    """

    def __init__(self, common: RobotModel, rows: FloatArray) -> None:
        self.__dict__ |= vars(common)
        self._data = self.pin_model.createData()  # of this thread
        self.common, self.rows = common, rows

    @property
    def inertial_parameters(self) -> Any:
        """Ten parameters of each moving body, shape (10 nq,), arrays over the arms; see RobotModel."""
        return over_runs(self.rows.reshape(len(self.rows), -1))

    @property
    def mass(self) -> Any:
        """Mass of all moving links of each arm, shape (runs,), in kg."""
        return sum(self.rows[:, body, 0] for body in range(self.nq))

    def mass_matrix(self, q: FloatArray) -> Any:
        """Return M(q), shape (nq, nq), arrays over the arms, in kg m^2."""
        theta, weight = self.inertial_parameters, self._regressor(q, np.zeros(self.nq))
        M = np.zeros((self.nq, self.nq), dtype=object)
        for column, way in enumerate(np.eye(self.nq)):
            Y = self._regressor(q, way) - weight
            for row in range(self.nq):
                M[row, column] = sum((Y[row, part] * theta[part] for part in np.flatnonzero(Y[row])), np.zeros(1))
        return M + np.diag(self.armature)

    def gravity_torque(self, q: Any) -> Any:
        """Return G(q), shape (nq,), arrays over the arms, in N m; joint positions, shape (nq,), may be such arrays."""
        theta, still = self.rows.reshape(len(self.rows), -1), np.zeros(self.nq)
        postures = np.broadcast_to(by_run(q), (len(theta), self.nq))
        pairs = zip(postures, theta, strict=True)
        return over_runs(np.array([(self._regressor(at, still) * own).sum(axis=1) for at, own in pairs]))

    def with_change(self, change: Callable[["pin.Model"], object]) -> "DrawnModel":
        """Return these arms with a change of the common arm; see RobotModel."""
        return DrawnModel(self.common.with_change(change), self.rows)

    def with_payload(self, mass: Any, position: FloatArray | None = None) -> "DrawnModel":
        """Return these arms with a point mass fixed at the tip; the mass may be an array over the arms."""
        frame = self.pin_model.frames[self.tip_frame]
        place = frame.placement.act(np.zeros(3) if position is None else position)
        rows = self.rows.copy()
        rows[:, frame.parentJoint - 1] += np.multiply.outer(
            np.broadcast_to(mass, len(rows)), pin.Inertia(1.0, place, np.zeros((3, 3))).toDynamicParameters()
        )
        return DrawnModel(self.common, rows)

    def _regressor(self, q: FloatArray, ddq: FloatArray) -> FloatArray:
        """Return the joint torque regressor at rest, shape (nq, 10 nq)."""
        Y: FloatArray = pin.computeJointTorqueRegressor(self.pin_model, self._data, q, np.zeros(self.nq), ddq).copy()
        return Y
