"""Compiled steps of PyBullet's arm; see runner/symbolic/bullet_step.py."""

from collections.abc import Callable
from functools import cached_property
from typing import Any

from runner.base.arrays import FloatArray
from runner.plants.compiled_motion import ArmCode, links_torques
from runner.robots.model import RobotModel
from runner.symbolic.arm import ArmConstants, constant_of, constants_of
from runner.symbolic.bullet_step import BulletArm, BulletLink, BulletStep, Functions
from runner.symbolic.code import ROWS, SCRATCH, STATE, Block, Part, Repeat, Slots, put
from runner.symbolic.expression import (
    Value,
    all_of,
    equal,
    less,
    library_cosine,
    library_sine,
    places,
    select,
)
from runner.symbolic.structure import any_number, arm_pattern
from runner.symbolic.vectors import Vector


def _inverse_above(value: Value, bound: float) -> Value:
    return select(less(value, bound), 0.0, 1.0 / value) if not isinstance(value, float) else 1.0 / value


_NO_NUMBERS = ("parent", "joint")
_FUNCTIONS = Functions(library_sine, library_cosine, _inverse_above)


def bullet_scalars(arm: BulletArm, number: Callable[[float], Any]) -> BulletArm:
    """Return an arm with its numbers converted by `number`; 0, 1 and -1 stay floats."""

    def scalar(value: Any) -> Any:
        if isinstance(value, list):
            return [scalar(entry) for entry in value]
        constant = constant_of(value)
        return number(value) if constant is None else constant

    links = list[BulletLink]()
    for link in arm.links:
        own = {
            name: scalar(part) for name, part in link._asdict().items() if name not in _NO_NUMBERS and part is not None
        }
        links.append(link._replace(**own))
    return BulletArm(links, [(joint, number(lower), number(upper)) for joint, lower, upper in arm.limits])


def bullet_pattern(arm: BulletArm, model: RobotModel) -> str:
    """Return a string that is the same for two arms with the same code."""
    return repr((bullet_scalars(arm, any_number), arm_pattern(model) if model.armature.any() else model.nq))


def expressed_steps(
    arm: BulletArm, armature: ArmConstants | None, acting: Vector, gravity: Vector, step: Value, at: Slots
) -> list[Part]:
    """Return the code of the steps of a tick, which does not change the state if a joint reaches a limit.

    A new slot of the state, after those in use, becomes 1 then, and stays.

    Args:
        arm: The arm; its positions and velocities begin the state.
        armature: Constants of an arm with armature; None without.
        acting: Held torques, shape (n,).
        gravity: Gravity vector, shape (3,).
        step: Step, in s.
        at: Allocator of slots.
    """
    n = len(acting)
    q, v = places(STATE, 0, n), places(STATE, n, n)
    last, (stopped,) = at.take(STATE, 1)
    first, own = at.take(SCRATCH, 2 * n + 1)
    own_q, own_v, free = own[:n], own[n : 2 * n], own[2 * n]
    links, parts = acting, list[Part]()
    if armature is not None:
        place, links = at.take(SCRATCH, n)
        parts.append(put(SCRATCH, place, links_torques(armature, own_q, own_v, acting, at)))
    within = [
        condition
        for joint, lower, upper in arm.limits
        for condition in (less(lower, own_q[joint]), less(own_q[joint], upper))
    ]
    after_q, after_v = BulletStep(arm, _FUNCTIONS).advance(own_q, own_v, links, gravity, step)
    goes_on = select(all_of([equal(free, 1.0), *within]), 1.0, 0.0)
    parts.append(put(SCRATCH, first, [*after_q, *after_v, goes_on]))
    kept = [select(equal(free, 1.0), new, old) for new, old in zip(own[: 2 * n], [*q, *v], strict=True)]
    return [
        put(SCRATCH, first, [*q, *v, 1.0 - stopped]),
        Repeat(parts, "steps", until_zero=first + 2 * n),
        Block([*((STATE, index, value) for index, value in enumerate(kept)), (STATE, last, 1.0 - free)]),
    ]


class CompiledBullet(ArmCode):
    """Compiled steps of one arm of PyBullet, with the torques of its armature.

    Args:
        model: Model of the arm, for its gravity and armature.
        arm: The arm as Bullet has it.
        step: Step, in s.
    """

    def __init__(self, model: RobotModel, arm: BulletArm, step: float) -> None:
        super().__init__(model, step)
        self._arm = arm

    def _names(self) -> tuple[str, str]:
        return f"Bullet {bullet_pattern(self._arm, self._model)}", f"PyBullet's step of {self._model.nq} joints"

    def _scalars(self, number: Callable[[float], Any]) -> tuple[Any, ...]:
        gravity = [number(value) for value in self._model.gravity.tolist()]
        own = constants_of(self._model, number, [0.0] * 3) if self._model.armature.any() else None
        return gravity, number(self._step), bullet_scalars(self._arm, number), own

    def _express(self, at: Slots) -> list[Part]:
        gravity, step, arm, own = self._scalars(at.number)
        at.take(STATE, 2 * self._model.nq)
        acting = at.take(ROWS, self._model.nq)[1]
        armature = None if own is None else own._replace(gravity=gravity)
        return expressed_steps(arm, armature, acting, gravity, step, at)

    @cached_property
    def _arrays(self) -> tuple[FloatArray, FloatArray]:
        return self._frame.state[:, 0], self._frame.rows[0, :, 0]

    def advance(self, state: FloatArray, tau: FloatArray, steps: int) -> bool:
        """Advance by a number of steps, in place; return False, without a change, if a joint reaches a limit.

        Args:
            state: Joint positions in rad, then velocities in rad/s, shape (2 nq,).
            tau: Held torques, shape (nq,), in N m.
            steps: Number of steps.
        """
        frame, (own, row) = self._frame, self._arrays
        own[:-1], own[-1], row[:], frame.steps[0] = state, 0.0, tau, steps
        frame.call()
        if own[-1]:
            return False
        state[:] = own[:-1]
        return True
