"""Compiled control loops of a tick: measurement, control law and torque limit; their choice, and their runs."""

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from runner.assembly.compiled.law import LawScalars, are_ours, expressed_torque, law_cache_key, law_scalars
from runner.assembly.run_config import RunConfig
from runner.base.arrays import FloatArray
from runner.base.errors import SimulationError
from runner.config.parsing import require
from runner.controllers.controller import Loop
from runner.controllers.torque_law import TorqueLaw
from runner.plants.motor_limits import TorqueLimits, torque_bounds
from runner.plugins.guard import Guarded, find_fault, place, unguarded
from runner.robots.drawn import DrawnModel, by_run, over_runs
from runner.robots.robot import Robot
from runner.sensing.encoders import EncoderNoise
from runner.sensing.velocity import first_state, gains, next_velocity
from runner.symbolic.algebra import PointScalars, expressed_points, point_scalars
from runner.symbolic.backend import SymbolicBackend
from runner.symbolic.code import GIVEN, ROWS, STATE, Block, Slots
from runner.symbolic.engine import MOST_JOINTS, evaluator
from runner.symbolic.expression import Value, both, equal, less, round_to_even, select
from runner.symbolic.maths import Array
from runner.symbolic.program import Expressed, Program, program
from runner.symbolic.structure import CannotCompileError, any_number, constants_in, values_of
from runner.symbolic.vectors import as_array


@dataclass(frozen=True)
class LoopCode:
    """A control loop.

    Attributes:
        law: Control law.
        joints: Commanded joints.
        every: Ticks between two ticks of the loop.
        period: Time between two ticks of the loop, in s.
        follows_joints: True if the reference is the desired motion of the joints.
    """

    law: TorqueLaw[Any]
    joints: slice
    every: int
    period: float
    follows_joints: bool = False


@dataclass(frozen=True)
class Commands:
    """All control loops of a robot, and their measurement.

    Attributes:
        robot: The robot.
        ignore_base_rotation: True if mounted stages keep their orientation at home.
        loops: The loops.
        noise: Noise, bias and resolution of the encoders.
        limits: Torque limits of all joints.
        guarded: True if torques that are not finite end the run as a failure of the law.
    """

    robot: Robot
    ignore_base_rotation: bool
    loops: tuple[LoopCode, ...]
    noise: EncoderNoise
    limits: TorqueLimits
    guarded: bool = False

    @cached_property
    def pattern(self) -> str:
        """A string that is the same for two sets of loops with the same code."""
        loops = [(law_cache_key(loop.law), loop.joints, loop.every > 1, loop.follows_joints) for loop in self.loops]
        points = point_scalars(self.robot, self.ignore_base_rotation, any_number)
        limits = [self.limits.joints_with_speed, *self._rounded.tolist()]
        return repr((loops, points, limits, self.noise.velocity))

    def program(self) -> Program:
        """Return the compiled code of a tick, for a plant that is not compiled.

        Raises:
            CannotCompileError: if a control law has no compiled form.
        """

        def express() -> Expressed:
            at = Slots()
            _, kept, errors = expressed_commands(self, self.scalars(at.number), at)
            return Expressed([kept], [], at.widths, errors)

        what = f"the control law of {len(self.limits.max)} joints"
        return program(f"commands {self.pattern}", what, express, 1, self.are_ours)

    @cached_property
    def values(self) -> FloatArray:
        """Values of the code's parameters, shape (k,)."""
        return values_of(self.scalars)

    def drawn_values(self, drawn: "Commands") -> FloatArray:
        """Return the parameters of this code for loops with drawn nominal models, shape (runs, k)."""
        return drawn.by_run(values_of(drawn.scalars, constants_in(self.scalars)))

    def by_run(self, values: FloatArray) -> FloatArray:
        """Return values of loops with drawn nominal models for each of their runs; the draws may change none of them.

        Args:
            values: The values, shape (k,) or (runs, k).
        """
        models = (model for loop in self.loops for model in loop.law.models)
        runs = next(len(model.rows) for model in models if isinstance(model, DrawnModel))
        return np.broadcast_to(values, (runs, values.shape[-1]))

    @property
    def are_ours(self) -> bool:
        """True if all laws are built-in."""
        return are_ours(law for loop in self.loops for law in _parts(loop.law))

    @property
    def _rounded(self) -> NDArray[np.bool_]:
        rounded: NDArray[np.bool_] = self.noise.resolution > 0.0
        return rounded

    @property
    def follow_joints(self) -> bool:
        """True if a loop follows the desired motion of the joints."""
        return any(loop.follows_joints for loop in self.loops)

    def scalars(self, number: Callable[[float], Any]) -> "CommandScalars":
        """Return the numbers of the loops as scalars, converted by `number`."""
        return CommandScalars(
            [number(limit) for limit in self.limits.max.tolist()],
            {joint: number(self.noise.resolution[joint]) for joint in np.flatnonzero(self._rounded).tolist()},
            [law_scalars(loop.law, loop.period, number) for loop in self.loops],
            point_scalars(self.robot, self.ignore_base_rotation, number),
            [
                [number(gain) for gain in gains(self.noise.velocity, self.noise.velocity_bandwidth, loop.period)]
                for loop in self.loops
            ],
            {joint: number(self.limits.no_load_speed[joint]) for joint in self.limits.joints_with_speed},
        )

    def fault(self, torque: FloatArray, time: float) -> SimulationError | None:
        """Return the failure of a user-supplied law with these torques, shape (nq,); None if they are finite."""
        if not self.guarded or np.isfinite(torque).all():
            return None
        for loop in self.loops:
            text = find_fault(torque[loop.joints], torque[loop.joints].shape)
            if text:
                return SimulationError(f"{place(loop.law.evaluate)} gave {text}", time)
        return None

    def shared(self, times: FloatArray, desired: FloatArray, joints: FloatArray | None = None) -> FloatArray:
        """Return time and path at each tick, shape (..., T, entries): the first entries of the space `given`.

        Args:
            times: Time of each tick, shape (T,), in s.
            desired: Desired motion of the tip, shape (..., T, 3, 3), of one run or of several.
            joints: Desired motion of the joints, shape (..., T, 3, nq); required if a loop follows it.
        """
        ticks, lead = np.arange(len(times)), desired.shape[:-2]
        own = [times, *(ticks % loop.every == 0 for loop in self.loops)]
        parts = [np.broadcast_to(np.stack(own, axis=-1, dtype=float), (*lead, len(own))), desired.reshape(*lead, 9)]
        if self.follow_joints and joints is not None:
            parts.append(joints.reshape(*lead, 3 * len(self.limits.max)))
        return np.concatenate(parts, axis=-1)

    def measured_wrong(self, errors: Sequence[FloatArray], ticks: int) -> FloatArray:
        """Return the errors of the positions in each tick, shape (..., T, entries): the next entries of `given`.

        Args:
            errors: Errors at the ticks of each loop, shape (..., n, nq), in rad.
            ticks: T, number of ticks.
        """
        numbers = np.arange(ticks)
        own = [
            wrong[..., :ticks, :] if loop.every == 1 else wrong[..., numbers // loop.every, :]
            for loop, wrong in zip(self.loops, errors, strict=True)
        ]
        return own[0] if len(own) == 1 else np.concatenate(own, axis=-1)

    def start(self, q: FloatArray, errors: Sequence[FloatArray]) -> FloatArray:
        """Return the initial state of runs at rest, shape (runs, entries).

        Args:
            q: Joint positions, shape (runs, nq), in rad; the runs are those of drawn nominal models, if any.
            errors: First errors of the positions that each loop measures, shape (runs, nq), in rad.
        """
        parts = [q, np.zeros_like(q)]
        for loop, wrong in zip(self.loops, errors, strict=True):
            measured = q + wrong
            self.noise.round(measured)
            parts += first_state(self.noise.velocity, measured)
            if len(loop.law.start(measured[0])):
                drawn = any(isinstance(model, DrawnModel) for model in loop.law.models)
                starts = loop.law.start(over_runs(measured)) if drawn else None
                own = [loop.law.start(each) for each in measured] if starts is None else by_run(starts)
                parts.append(np.broadcast_to(own, (len(q), np.shape(own)[-1])))
            if loop.every > 1:
                parts.append(np.zeros((len(q), loop.joints.stop - loop.joints.start)))
        return np.concatenate(parts, axis=1)


def find_commands(config: RunConfig, loops: Sequence[Loop]) -> Commands | None:
    """Return the control loops of a run for compilation; None if one of them has no compiled form."""
    limits, tick = config.torque_limits, config.timing.tick
    laws = [unguarded(loop.controller) for loop in loops]
    if not evaluator() or not all(isinstance(law, TorqueLaw) and law.compilable for law in laws):
        return None
    if config.interpreted:
        _tell(f"{' and '.join(config.interpreted)}: no compiled form; the control loops are interpreted")
        return None
    nq = len(limits.max)
    if nq > MOST_JOINTS:
        _tell(f"the arm has {nq} joints, and code is made for {MOST_JOINTS} or fewer: laws are not compiled")
        return None
    joints = range(nq)
    codes = [
        LoopCode(
            law, slice(*loop.joints.indices(len(joints))), round(loop.period / tick), loop.period, loop.follows_joints
        )
        for law, loop in zip(laws, loops, strict=True)
    ]
    guarded = any(isinstance(loop.controller, Guarded) for loop in loops)
    noise = require(config.encoder_noise)
    return Commands(config.arm, config.ignore_base_rotation, tuple(codes), noise, limits, guarded)


def compiled(commands: Commands | None) -> Commands | None:
    """Return control loops after their compilation; None if they cannot be compiled, after printing the reason."""
    try:
        if commands is not None:
            commands.program()
        return commands
    except CannotCompileError as error:
        _tell(str(error))
        return None


@lru_cache(maxsize=64)
def _tell(text: str) -> None:
    print(f"runner: {text}", file=sys.stderr)


def _parts(law: TorqueLaw[Any]) -> Iterator[TorqueLaw[Any]]:
    yield law
    for part in vars(law).values():
        if isinstance(part, TorqueLaw):
            yield from _parts(part)


class CommandScalars(NamedTuple):
    """The numbers of all loops.

    Attributes:
        limits: Torque limit of each joint, shape (nq,), in N m.
        resolution: Resolution of the encoders, by joint, in rad; only for joints with one.
        laws: Numbers of each loop's law.
        points: Numbers of the stages' end points.
        velocity: Gains of each loop's velocity estimate.
        no_load_speeds: No-load speed, by joint, in rad/s; only for joints with one.
    """

    limits: Sequence[Value]
    resolution: dict[int, Value]
    laws: Sequence[LawScalars]
    points: tuple[PointScalars, ...]
    velocity: Sequence[Sequence[Value]]
    no_load_speeds: Mapping[int, Value]


def expressed_commands(commands: Commands, numbers: CommandScalars, at: Slots) -> tuple[list[Value], Block, list[str]]:
    """Return the torques of a tick, the block of stored values, and the messages of possible failures.

    Call this function first, because it takes the first slots. A row contains joint positions, velocities and torques,
    each of shape (nq,), the number of the failure, 0 for none, and the end points of the stages; see Rows.

    Raises:
        CannotCompileError: if a law uses an operation that expressions do not support.
    """
    nq, loops = len(commands.limits.max), range(len(commands.loops))
    (time,), due = at.take(GIVEN, 1)[1], at.take(GIVEN, len(loops))[1]
    tip = as_array(at.take(GIVEN, 9)[1]).reshape(3, 3)
    joints = as_array(at.take(GIVEN, 3 * nq)[1]).reshape(3, nq) if commands.follow_joints else tip
    errors = [at.take(GIVEN, nq)[1] for _ in loops]
    q, dq = at.take(STATE, nq)[1], at.take(STATE, nq)[1]
    references = [joints if loop.follows_joints else tip for loop in commands.loops]
    given = [_Given(time, due[loop], references[loop], q, dq, errors[loop]) for loop in loops]
    torques: list[Value] = [0.0] * nq
    kept: list[tuple[str, int, Any]] = []
    texts: list[str] = []
    fault: Value = 0.0
    for loop, own, gain, its in zip(commands.loops, numbers.laws, numbers.velocity, given, strict=True):
        asked, changes, backend = _asked(commands, loop, own, gain, numbers, its, at)
        torques[loop.joints] = asked
        kept += changes
        failed = both(equal(fault, 0.0), less(0.0, backend.fault))
        if loop.every > 1:
            failed = both(failed, less(0.5, its.due))
        fault = select(failed, backend.fault + float(len(texts)), fault)
        texts += backend.errors
    shown = [*q, *dq, *torques, fault, *expressed_points(numbers.points, q)]
    kept += _at(ROWS, at.take(ROWS, len(shown))[0], shown)
    return torques, Block(kept), texts


class _Given(NamedTuple):
    """Inputs of a loop in a tick; `due` is 1 in a tick of the loop, else 0."""

    time: Value
    due: Value
    reference: Array
    q: Sequence[Value]
    dq: Sequence[Value]
    errors: Sequence[Value]


def _asked(
    commands: Commands,
    loop: LoopCode,
    own: LawScalars,
    gain: Sequence[Value],
    numbers: CommandScalars,
    given: _Given,
    at: Slots,
) -> tuple[list[Value], list[tuple[str, int, Any]], SymbolicBackend]:
    """Return the torques of a loop, the changes of its state, and the backend with possible failures."""
    measured = [position + wrong for position, wrong in zip(given.q, given.errors, strict=True)]
    for joint, step in numbers.resolution.items():
        measured[joint] = round_to_even(measured[joint] / step) * step
    velocity: Sequence[Value] = given.dq
    changes: list[tuple[str, int, Any]] = []
    way, count = commands.noise.velocity, len(measured)
    if way != "exact":
        kept = [at.take(STATE, count) for _ in first_state(way, np.zeros(count))]
        before = [as_array(values) for _, values in kept]
        found, after = next_velocity(way, gain, own.period, as_array(measured), before)
        velocity = found.tolist()
        for (first, values), new in zip(kept, after, strict=True):
            changes += _at(STATE, first, _in_own_ticks(loop, given, values, new.tolist()))
    first, memory = at.take(STATE, len(loop.law.start(np.zeros(len(measured)))))
    asked, goes_on, backend = expressed_torque(loop.law, own, given.time, measured, velocity, given.reference, memory)
    changes += _at(STATE, first, _in_own_ticks(loop, given, memory, goes_on))
    commanded = zip(range(count)[loop.joints], asked, strict=True)
    torques = [_clip(torque, *_bounds(numbers, joint, given.dq)) for joint, torque in commanded]
    if loop.every > 1:
        first, held = at.take(STATE, len(torques))
        torques = _in_own_ticks(loop, given, held, torques)
        changes += _at(STATE, first, torques)
    return torques, changes, backend


def _in_own_ticks(loop: LoopCode, given: _Given, before: Sequence[Value], after: Sequence[Value]) -> list[Value]:
    """Return values that change only in the ticks of a loop."""
    if loop.every == 1:
        return list(after)
    return [select(less(0.5, given.due), new, old) for new, old in zip(after, before, strict=True)]


def _at(space: str, first: int, values: Sequence[Any]) -> list[tuple[str, int, Any]]:
    return [(space, first + index, value) for index, value in enumerate(values)]


def _bounds(numbers: CommandScalars, joint: int, dq: Sequence[Value]) -> tuple[Value, Value]:
    limit = numbers.limits[joint]
    if joint not in numbers.no_load_speeds:
        return -limit, limit
    return torque_bounds(_maximum, limit, numbers.no_load_speeds[joint], dq[joint])


def _maximum(a: Value, b: Value) -> Value:
    return select(less(a, b), b, a)


def _clip(torque: Value, lowest: Value, highest: Value) -> Value:
    """Return a torque within bounds; NaN stays."""
    below = select(less(highest, torque), highest, torque)
    return select(less(below, lowest), lowest, below)
