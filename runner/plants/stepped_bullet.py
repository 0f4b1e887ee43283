"""PyBullet's arm by its compiled step, and by PyBullet itself from the tick at which a joint reaches a limit."""

import hashlib
import json
import sys
from collections.abc import Callable
from functools import lru_cache

import numpy as np

from runner.base import engines
from runner.base.arrays import FloatArray
from runner.base.cache import read_answer, write_answer
from runner.base.errors import SimulationError
from runner.plants.agreement import has_bits_of_bullet
from runner.plants.bullet_links import read_arm
from runner.plants.compiled_bullet import CompiledBullet, bullet_pattern
from runner.plants.decoupled import BulletMotion
from runner.plants.plant import Plant
from runner.robots.description import find_urdf, read_urdf
from runner.robots.model import RobotModel
from runner.robots.mounting import TOOL_MOUNT
from runner.symbolic.bullet_step import VERSION, BulletArm
from runner.symbolic.engine import MOST_JOINTS, evaluator, processor
from runner.symbolic.program import source_digest

_TICKS, _FEWER = 500, 50  # that are compared, and if another arm with the same code was equal
_WHEEL = "3.2.7"  # of PyBullet, with the Bullet of the compiled step


class SteppedBullet(Plant):
    """An arm of PyBullet, moved by its compiled step.

    PyBullet moves the arm from the tick in which a joint reaches a limit until the next reset, and always if there is a
    wall. The motion has the bits of PyBullet's own steps.

    Args:
        code: Compiled step.
        model: Model of the arm.
        steps_per_tick: Integration steps for which the torques of one tick are held.
        make: Function that builds the arm in PyBullet.
    """

    def __init__(self, code: CompiledBullet, model: RobotModel, steps_per_tick: int, make: Callable[[], Plant]) -> None:
        self._code, self._steps_per_tick, self._make = code, steps_per_tick, make
        self._state = np.zeros(2 * model.nq)
        self.q, self.dq = np.split(self._state, 2)
        self._gravity = model.gravity
        self._engine: Plant | None = None
        self._by_engine = self._has_wall = False

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Reset the arm to a state; see Plant."""
        self.q[:], self.dq[:] = q, dq
        self._by_engine = False
        if self._has_wall:
            self._hand_over()

    def set_gravity(self, gravity: FloatArray) -> None:
        """Set the gravity vector; see Plant."""
        self._gravity = gravity.copy()
        self._code.set_gravity(gravity)
        if self._by_engine and self._engine is not None:
            self._engine.set_gravity(gravity)

    def advance(self, tau: FloatArray) -> None:
        """Hold the torques for one tick; see Plant."""
        if not self._by_engine:
            if self._code.advance(self._state, tau, self._steps_per_tick):
                return
            if not engines.has_pybullet():
                raise SimulationError(
                    "a joint reaches its position limit; PyBullet goes on there, but is not installed"
                )
            self._hand_over()
        engine = self._opened()
        engine.advance(tau)
        self.q[:], self.dq[:] = engine.q, engine.dq

    def _hand_over(self) -> None:
        """Give the state to PyBullet, which goes on."""
        engine = self._opened()
        engine.set_gravity(self._gravity)
        engine.reset(self.q, self.dq)
        self._by_engine = True

    def _opened(self) -> Plant:
        if self._engine is None:
            self._engine = self._make()
        return self._engine

    def add_wall(self, point: FloatArray, normal: FloatArray, stiffness: float, damping: float) -> bool:
        """Add a wall in PyBullet; see Plant."""
        self._has_wall = self._opened().add_wall(point, normal, stiffness, damping)
        self._hand_over()
        return self._has_wall

    def contact_wrench(self) -> FloatArray | None:
        """Return the wrench of the wall on the arm; see Plant."""
        return self._opened().contact_wrench() if self._has_wall else np.zeros(6)

    def close(self) -> None:
        """Release PyBullet's server."""
        if self._engine is not None:
            self._engine.close()


def find_step(urdf: str, model: RobotModel, step: float, steps_per_tick: int) -> CompiledBullet | None:
    """Return the compiled step of an arm; None if PyBullet moves it. See find_motion_of."""
    found = find_motion_of(urdf, model, step, steps_per_tick)
    return None if found is None else CompiledBullet(model, found.arm, found.step)


def find_motion_of(urdf: str, model: RobotModel, step: float, steps_per_tick: int) -> BulletMotion | None:
    """Return the motion of an arm by Bullet's step; None if PyBullet moves it.

    PyBullet moves an arm with a tool sensor, an arm whose step is not known, and ticks that it does not divide as
    asked. On the first use of an arm, its step is compared with PyBullet; see has_bits_of_bullet.

    Args:
        urdf: Canonical text of the arm.
        model: Model of the arm.
        step: Integration step, in s.
        steps_per_tick: Integration steps in a tick.

    Raises:
        ConfigError: if PyBullet cannot load the text.
    """
    arm = find_arm(urdf, model)
    at_once = 1 if model.armature.any() else steps_per_tick
    return BulletMotion(arm, substep(step, at_once)) if arm is not None and divides(step, at_once) else None


def bullet_versions() -> dict[str, str]:
    """Return the versions that name runs of plant=bullet: that of the compiled step.

    That of an installed PyBullet is added if it contains another Bullet, and moves the built-in Macro by other bits.
    """
    own, found = {"bullet": VERSION}, engines.installed_versions(["pybullet"])
    if found.get("pybullet", _WHEEL) == _WHEEL:
        return own
    urdf = read_urdf(find_urdf("macro.urdf"), {})
    return own if find_arm(urdf, RobotModel(urdf, "tip")) is not None else own | found


@lru_cache(maxsize=64)
def find_arm(urdf: str, model: RobotModel) -> BulletArm | None:
    """Return an arm as Bullet has it, if its compiled step has the bits of PyBullet; else None. See find_motion_of."""
    if not evaluator() or model.nq > MOST_JOINTS or f'"{TOOL_MOUNT}"' in urdf:
        return None
    arm = read_arm(urdf, model.joint_names)
    return arm if arm is not None and _is_trusted(urdf, model, arm) else None


def substep(step: float, at_once: int) -> float:
    """Return the step that Bullet takes if it divides a tick into `at_once` steps, in s."""
    return step if at_once == 1 else (step * at_once) / at_once


def divides(step: float, at_once: int) -> bool:
    """Return True if Bullet makes `at_once` steps in each tick, without a remainder of time by rounding."""
    tick, own = step * at_once, substep(step, at_once)
    return at_once == 1 or (int(tick / own) == at_once and tick - at_once * own == 0.0)


def _is_trusted(urdf: str, model: RobotModel, arm: BulletArm) -> bool:
    """Return True if the compiled step of an arm has the bits of the installed PyBullet; print it if not."""
    if not engines.has_pybullet():
        _tell("PyBullet is not installed: the step of plant=bullet is not compared on this machine")
        return True
    about = engines.installed_versions(("llvmlite", "pybullet")), processor(), source_digest()
    own, alike = (
        f"step-{hashlib.sha256(json.dumps([text, *about]).encode()).hexdigest()}"
        for text in (urdf, bullet_pattern(arm, model))
    )
    found = read_answer(own)
    if not isinstance(found, bool):
        ticks = _FEWER if read_answer(alike) is True else _TICKS
        found = has_bits_of_bullet(urdf, model, arm, ticks, np.random.default_rng(0))
        for key in (own, alike):
            write_answer(key, found)
    if not found:
        _tell("the compiled step of plant=bullet differs from the installed PyBullet, which moves the arm")
    return found


@lru_cache(maxsize=4)
def _tell(text: str) -> None:
    print(f"runner: {text}", file=sys.stderr)
