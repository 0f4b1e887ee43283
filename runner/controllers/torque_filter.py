"""Filters of the torques of any controller, such as notches and disturbance observers."""

from abc import ABC, abstractmethod
from typing import Any, NamedTuple

import numpy as np

from runner.base.arrays import FloatArray
from runner.controllers.controller import Controller
from runner.controllers.torque_law import Arm, Arms, TorqueLaw, structure_of
from runner.plugins.guard import guarded_like, unguarded
from runner.robots.model import RobotModel
from runner.symbolic.maths import Array, Scalar


class TorqueFilter(ABC):
    """A filter of the torques of a control law.

    Attributes:
        models: The arms of the filter, in addition to those of the law.
        parameters: Parameters of the filter; see TorqueLaw.
        reads_joint_torques: True if the filter uses the joint torque sensors, by `measured`.
    """

    models: tuple[RobotModel, ...] = ()
    parameters: Any
    reads_joint_torques = False

    def structure(self) -> dict[str, Any]:
        """Return the structure of the filter, without its parameters; see TorqueLaw.structure."""
        return structure_of(self)

    @property
    @abstractmethod
    def state_size(self) -> int:
        """Size of the state."""

    def start(self, q: FloatArray) -> FloatArray:
        """Return the state before the first tick, from the measured joint positions, shape (nq,), in rad."""
        return np.zeros(self.state_size)

    def measured(self, state: FloatArray, reading: FloatArray) -> FloatArray:
        """Return the state with the torques measured since the last tick, of every joint, shape (nq,)."""
        return state

    @abstractmethod
    def filter(
        self, arm: Arm, parameters: Any, time: Scalar, q: Array, dq: Array, torque: Array, state: Array
    ) -> tuple[Array, Array]:
        """Return the filtered torques, shape (n,), in N m, and the state for the next tick.

        Args:
            arm: The arm of the filter; any arm for a filter without arms.
            parameters: The parameters of the filter.
            time: Time since the start, in s.
            q: Measured joint positions, shape (nq,), in rad.
            dq: Measured joint velocities, shape (nq,), in rad/s.
            torque: Torques of the law, shape (n,), in N m.
            state: State of the last tick, or `start`.
        """


class FilteredParameters(NamedTuple):
    """The parameters of a law with a filter."""

    law: Any
    filter: Any


class AnyLaw(TorqueLaw[tuple[()]]):
    """A controller of any kind as a torque law, which is not compiled.

    Args:
        controller: The controller.
        model: The nominal robot.
    """

    compilable = False

    def __init__(self, controller: Controller, model: RobotModel) -> None:
        super().__init__([model], True, ())
        self._controller = controller

    def reset(self) -> None:
        """Clear the state of an earlier run."""
        self._controller.reset()

    def evaluate(
        self, arms: Arms, parameters: tuple[()], time: Scalar, q: Array, dq: Array, reference: Array, state: Array
    ) -> tuple[Array, Array]:
        """Return the torques of the controller; see TorqueLaw."""
        return self._controller.torque(time, q, dq, reference), state


class FilteredLaw(TorqueLaw[FilteredParameters]):
    """A torque law with a filter, which is compiled if the law can be.

    Args:
        law: The law.
        torque_filter: The filter.
    """

    def __init__(self, law: TorqueLaw[Any], torque_filter: TorqueFilter) -> None:
        parameters = FilteredParameters(law.parameters, torque_filter.parameters)
        super().__init__([*law.models, *torque_filter.models], law.gravity_compensation, parameters, law.measured)
        self._law, self._filter = law, torque_filter
        self.reads_joint_torques = torque_filter.reads_joint_torques
        self.compilable = law.compilable

    def reset(self) -> None:
        """Clear the state of an earlier run."""
        super().reset()
        self._law.reset()

    def read_joint_torques(self, reading: FloatArray) -> None:
        """Store the mean torques on the links since the last tick; see ControlLaw."""
        if self.state is not None:
            own = len(self.state) - self._filter.state_size
            self.state = np.concatenate([self.state[:own], self._filter.measured(self.state[own:], reading)])

    def start(self, q: FloatArray) -> FloatArray:
        """Return the states of law and filter at the first tick; see TorqueLaw."""
        return np.concatenate([self._law.start(q), self._filter.start(q)])

    def evaluate(
        self,
        arms: Arms,
        parameters: FilteredParameters,
        time: Scalar,
        q: Array,
        dq: Array,
        reference: Array,
        state: Array,
    ) -> tuple[Array, Array]:
        """Return the filtered torques, and the states of law and filter; see TorqueLaw."""
        own, of_law = len(state) - self._filter.state_size, arms[: len(self._law.models)]
        torque, kept = self._law.evaluate(of_law, parameters.law, time, q, dq, reference, state[:own])
        passed, seen = self._filter.filter(arms[-1], parameters.filter, time, q, dq, torque, state[own:])
        return passed, np.concatenate([kept, seen])


def with_filter(controller: Controller, torque_filter: TorqueFilter, model: RobotModel) -> Controller:
    """Return a controller with a filter; a guarded law stays guarded.

    Args:
        controller: The controller.
        torque_filter: The filter.
        model: The nominal robot.
    """
    law = unguarded(controller)
    if torque_filter.reads_joint_torques or not isinstance(law, TorqueLaw):
        return FilteredLaw(AnyLaw(controller, model), torque_filter)
    filtered: Controller = guarded_like(controller, FilteredLaw(law, torque_filter))
    return filtered
