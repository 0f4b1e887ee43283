"""A control law that is one function of the user, with the desired motion of joints and tip and a nominal arm."""

import inspect
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from pathlib import Path
from types import ModuleType
from typing import Any, Literal

import numpy as np
from pydantic import create_model

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError, SimulationError
from runner.base.sanitize import quoted
from runner.controllers.joint_space.joint_law import (
    JointLawConfig,
    JointMotion,
    JointMotionParameters,
    joint_law_builder,
    start_posture,
)
from runner.controllers.torque_law import Arm, Arms, TorqueLaw
from runner.plugins.guard import find_fault, place, read_only
from runner.robots.model import RobotModel
from runner.schema.model import StrictModel

ARGUMENTS = ("t", "q", "dq", "desired", "arm")
"""First arguments of a function; the other arguments are keys of the config."""
_OF_KEY = "a key needs a default: a number, true or false, a string, or a list of numbers"


@dataclass(frozen=True)
class DesiredMotion:
    """Desired motion at a tick, in SI units.

    Attributes:
        q: Joint positions, shape (nq,); of a tip motion those of a virtual arm, see JointMotion.
        dq: Joint velocities, shape (nq,).
        ddq: Joint accelerations, shape (nq,).
        x: Tip position in the base frame, shape (3,); of a joint motion that of the nominal arm.
        dx: Tip velocity, shape (3,).
        ddx: Tip acceleration, shape (3,).
    """

    q: FloatArray
    dq: FloatArray
    ddq: FloatArray
    x: FloatArray
    dx: FloatArray
    ddx: FloatArray


class NominalArm:
    """Dynamics and kinematics of the nominal arm; each method returns a new array.

    Args:
        arm: The arm, over floats.
    """

    def __init__(self, arm: Arm) -> None:
        self._arm = arm

    def M(self, q: FloatArray) -> FloatArray:  # noqa: N802 - as in the papers
        """Return the mass matrix, shape (nq, nq), in kg m^2."""
        upper = np.triu(self._arm.mass_matrix(q))
        return np.asarray(upper + np.triu(upper, 1).T)

    def h(self, q: FloatArray, dq: FloatArray) -> FloatArray:
        """Return V(q, dq) + G(q), shape (nq,), in N m: M ddq + h = tau."""
        return np.array(self._arm.inverse_dynamics(q, dq, np.zeros(len(q))))

    def g(self, q: FloatArray) -> FloatArray:
        """Return the gravity term G(q), shape (nq,), in N m."""
        return self.h(q, np.zeros(len(q)))

    def J(self, q: FloatArray) -> FloatArray:  # noqa: N802 - as in the papers
        """Return the Jacobian of x, shape (3, nq)."""
        return np.array(self._arm.tip(q, np.zeros(len(q))).J[:3])

    def x(self, q: FloatArray) -> FloatArray:
        """Return the tip position in the base frame, shape (3,), in m."""
        return np.array(self._arm.tip_pose(q)[0])


class FunctionLaw(TorqueLaw[JointMotionParameters]):
    """A torque law that calls a function.

    Args:
        function: The function.
        names: Names of the keys that the function receives.
        model: The arm.
        config: Config of the law.
        rest: Configuration of the posture task, shape (nq,), in rad.
        joints: True if the desired motion is a joint motion; see JointMotion.

    Raises:
        ConfigError: see JointMotion.
    """

    compilable = False

    def __init__(
        self,
        function: Callable[..., Any],
        names: Sequence[str],
        model: RobotModel,
        config: JointLawConfig,
        rest: FloatArray,
        joints: bool = False,
    ) -> None:
        self._function, self._joints, self._feedforward = function, joints, config.feedforward
        self._keys = {
            name: read_only(np.array(key)) if isinstance(key, list) else key
            for name in names
            for key in [getattr(config, name)]
        }
        self._motion = JointMotion(model, config, rest, joints)
        super().__init__([model], config.gravity_compensation, self._motion.parameters)

    def start(self, q: FloatArray) -> FloatArray:
        """Return the state of the desired motion at the first tick; see TorqueLaw."""
        return self._motion.start(q)

    def evaluate(
        self,
        arms: Arms,
        parameters: JointMotionParameters,
        time: float,
        q: FloatArray,
        dq: FloatArray,
        reference: FloatArray,
        state: FloatArray,
    ) -> tuple[FloatArray, FloatArray]:
        """Return the torques of the function, and the state of the desired motion; see TorqueLaw.

        Raises:
            SimulationError: if the function does not return finite torques, shape (nq,).
        """
        (arm,) = arms
        joints, goes_on = self._motion.follow(arm, parameters, reference, state)
        if self._joints:
            tip = arm.tip(joints.q, joints.dq)
            x, dx, ddx = tip.x, tip.J[:3].dot(joints.dq), tip.J[:3].dot(joints.ddq) + tip.dJ_dq[:3]
        else:
            x, dx, ddx = reference if self._feedforward else (reference[0], np.zeros(3), np.zeros(3))
        desired = read_only(DesiredMotion(joints.q, joints.dq, joints.ddq, x, dx, ddx))
        torque = self._function(time, q, dq, desired, NominalArm(arm), **self._keys)
        if fault := find_fault(torque, q.shape):
            raise SimulationError(f"{place(self._function)} gave {fault}")
        return np.array(torque, dtype=np.float64), goes_on


@lru_cache(maxsize=64)
def function_module(function: Any, name: str, module: ModuleType) -> ModuleType:
    """Return a module of a controller for a function of the user.

    The module has `CONFIG` and `build`, and in `VALUES` the keys with their default values.

    Args:
        function: The function.
        name: Name of the function in the module.
        module: The module that contains the function.

    Raises:
        ConfigError: if it is not a Python function with the arguments ARGUMENTS and others with defaults, or was not
            defined in the file of the module.
    """
    file = Path(module.__file__ or "?")
    if not inspect.isfunction(function):
        raise ConfigError(
            f"controller.kind: '{name}' in {file.name} is not a Python function (found {quoted(function)}). Name one "
            "that the file defines by `def`"
        )
    if Path(function.__code__.co_filename) != file:
        raise ConfigError(
            f"controller.kind: the source of '{name}' is not in {file.name} (found {place(function)}). Name the file "
            "that defines it"
        )
    problems = list(_faults(function))
    if problems:
        raise ConfigError(f"controller.kind: {place(function)}: {problem}" for problem in problems)
    values = {each.name: each.default for each in _keys(function)}
    made = ModuleType(f"{module.__name__}:{name}", function.__doc__)
    own: dict[str, Any] = {"kind": (Literal[name], ...)} | {
        key: (_type(value), ...) for key, value in values.items() if key not in JointLawConfig.model_fields
    }
    config = create_model("FunctionConfig", __base__=JointLawConfig, **own)
    vars(made).update(
        CONFIG=config,
        FOLLOWS_JOINTS=True,
        VALUES={"kind": name} | {key: [*value] if isinstance(value, tuple) else value for key, value in values.items()},
        build=joint_law_builder(partial(FunctionLaw, function, tuple(values))),
        start_posture=start_posture,
    )
    return made


def _keys(function: Callable[..., Any]) -> list[inspect.Parameter]:
    return list(inspect.signature(function, follow_wrapped=False).parameters.values())[len(ARGUMENTS) :]


def _faults(function: Callable[..., Any]) -> Iterator[str]:
    given = list(inspect.signature(function, follow_wrapped=False).parameters.values())
    first = tuple(each.name for each in given[: len(ARGUMENTS)])
    if first != ARGUMENTS or any(each.default is not each.empty for each in given[: len(ARGUMENTS)]):
        yield f"its first arguments must be {', '.join(ARGUMENTS)}; found ({', '.join(map(str, given))})"
        return
    for each in _keys(function):
        if each.kind not in (each.POSITIONAL_OR_KEYWORD, each.KEYWORD_ONLY):
            yield f"argument '{each}' cannot be a key; after {ARGUMENTS[-1]} only names with a default are allowed"
        elif each.default is each.empty:
            yield f"argument '{each.name}' has no default; {_OF_KEY}"
        elif _type(each.default) is None:
            yield f"argument '{each.name}' has the default {quoted(each.default)}; {_OF_KEY}"
        elif each.name == "kind" or each.name.startswith("_") or hasattr(StrictModel, each.name):
            yield f"argument '{each.name}' cannot be a key; take another name"


def _type(default: object) -> Any:
    """Return the type of a key by its default value; None if it cannot be one."""
    if isinstance(default, bool | str):
        return type(default)
    if isinstance(default, int | float):
        return float
    if isinstance(default, list | tuple) and default and all(_type(each) is float for each in default):
        return list[float]
    return None
