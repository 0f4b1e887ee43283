"""Compiled torque laws: the torques of Pinocchio's evaluation, memory, errors, and what cannot be compiled."""

from copy import copy
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import pytest
from support import strangers
from support.arms import checked

from runner.assembly.compiled import commands as loops
from runner.assembly.compiled.commands import Commands, LoopCode
from runner.assembly.compiled.law import law_cache_key
from runner.assembly.compiled.loops import CompiledLoops
from runner.base.errors import SimulationError
from runner.controllers import Loop, guard_law
from runner.controllers.torque_law import TorqueLaw
from runner.plants import compiled_motion
from runner.plants.motor_limits import TorqueLimits
from runner.plugins.guard import unguarded
from runner.sensing.encoders import EncoderNoise
from runner.symbolic import program
from runner.symbolic.structure import CannotCompileError
from tools.laws import ARM_LAWS, JOINT_LAWS, LAWS

OTHER_ARMS = [
    *((robot, "operational_space") for robot in ("mini", "xarm7", "meca500", "crane", "planar_two", "planar")),
    ("combined", "whole_body"),
    *((robot, "computed_torque") for robot in ("xarm7", "mixed", "planar")),
    ("xarm7", "joint_pd"),
    *((robot, "impedance") for robot in ("mini", "planar")),
    *((robot, "adaptive") for robot in ("meca500", "mixed")),
]
CASES = [
    *OTHER_ARMS,
    *(("macro", law) for law in (*ARM_LAWS, *(name for name, law in LAWS.items() if law.flexible))),
    # Costly to express; the session has each law on the Macro, and seven joints under three others.
    *(pytest.param("xarm7", law, marks=pytest.mark.slow) for law in JOINT_LAWS if ("xarm7", law) not in OTHER_ARMS),
]


def configured(robot, controller, *overrides):
    chosen = f"controller={controller}", "trajectory=goal", *overrides
    if LAWS[controller].flexible:
        chosen = (*chosen, "plant=rk4_flexible", "plant.flexible_joints.static_deflection=unknown")
    if robot in strangers.STRANGERS:
        return strangers.config(robot, *chosen)
    return checked(f"robot={robot}", *chosen)


def law_of(robot, controller, *overrides):
    (loop,) = configured(robot, controller, *overrides).loops
    return loop.controller


def smallest(model, q, rows):
    return np.linalg.svd(model.tip_jacobian(q)[:rows], compute_uv=False)[-1] / model.reach


def states(model, home, rows=3, wide=1.0, count=12, near=False):
    """Measurements with references, away from singular configurations or near one."""
    generator, found, directions = np.random.default_rng(3), [], min(rows, model.nq)
    while len(found) < count:
        q = home + wide * generator.normal(size=model.nq)
        if directions < 3 or (smallest(model, q, rows) < 0.08) == near:
            reference = generator.normal(size=(3, 3))
            reference[0] = model.tip_position(q) + 0.05 * model.reach * generator.normal(size=3)
            found.append((q, generator.normal(size=model.nq), reference))
    return found


def compiled_torques(law, measured):
    """Return the torques of a law's compiled form in a row of measurements."""
    n = law.models[0].nq
    robot = SimpleNamespace(model=law.models[0], stages=(None,))
    exact = EncoderNoise(*np.zeros((3, n)), "none", "exact")
    commands = Commands(
        robot, False, (LoopCode(law, slice(0, n), 1, 0.01),), exact, TorqueLimits.constant(np.full(n, np.inf))
    )
    references = np.array([reference for _, _, reference in measured])
    run = CompiledLoops(commands, len(measured), [np.zeros((len(measured), n))])
    run.start(0.01 * np.arange(len(measured)), references, None, measured[0][0])
    for tick, (q, dq, _) in enumerate(measured):
        run.update(tick, q, dq)
    return run.rows.command


def assert_agree(law, ours, measured, tolerance=1e-12):
    """Compare the torques of a law by Pinocchio with those of another one's compiled form."""
    law.reset()
    found = compiled_torques(ours, measured)
    for tick, (q, dq, reference) in enumerate(measured):
        expected = law.torque(0.01 * tick, q, dq, reference)
        np.testing.assert_allclose(found[tick], expected, rtol=0.0, atol=tolerance * np.abs(expected).max())


@pytest.mark.parametrize(("robot", "controller"), CASES)
def test_torques_are_those_of_pinocchio(robot, controller):
    config = configured(robot, controller)
    (loop,) = config.loops
    assert_agree(loop.controller, loop.controller, states(config.arm.model, config.arm.home))


@pytest.mark.parametrize("controller", ["operational_space", "computed_torque"])
def test_torques_of_a_pose_are_those_of_pinocchio(controller):
    config = configured("xarm7", controller, "controller.task=pose")
    (loop,) = config.loops
    ours, measured = loop.controller, states(config.arm.model, config.arm.home, rows=6, wide=0.2)
    # A mobility of six rows has a condition number of about 1e4.
    assert_agree(loop.controller, ours, measured, 1e-11)


@pytest.mark.parametrize(("robot", "controller"), [("macro", "operational_space"), ("xarm7", "operational_space")])
def test_damping_near_a_singular_posture_is_that_of_pinocchio(robot, controller):
    config = configured(robot, controller)
    (loop,) = config.loops
    assert_agree(loop.controller, loop.controller, states(config.arm.model, config.arm.home, near=True), 1e-9)


@pytest.mark.parametrize(
    "overrides",
    [
        ("controller.gravity_compensation=false",),
        ("controller.feedforward=false",),
        ("controller.singularity_damping=0",),
        ("controller.null_space_frequency=0",),
    ],
)
def test_what_the_config_leaves_out_is_left_out(overrides):
    config = configured("xarm7", "operational_space", *overrides)
    (loop,) = config.loops
    assert_agree(loop.controller, loop.controller, states(config.arm.model, config.arm.home, count=4))


def test_a_speed_limit_bounds_the_pull():
    config = configured("combined", "whole_body", "controller.max_tip_speed=0.05")
    (loop,) = config.loops
    assert_agree(loop.controller, loop.controller, states(config.arm.model, config.arm.home, wide=0.4))


def test_memory_goes_on_from_tick_to_tick_until_it_is_reset():
    config = configured("macro", "computed_torque", "controller.integral_gain=500")
    (loop,) = config.loops
    measured = states(config.arm.model, config.arm.home, count=40)
    assert_agree(loop.controller, loop.controller, measured)
    assert_agree(
        loop.controller, loop.controller, measured[::-1]
    )  # it starts again where this measurement finds the arm


def test_numbers_are_parameters_and_zeros_are_not(monkeypatch):
    law, other = (law_of("macro", "operational_space", f"controller.natural_frequency={w}") for w in (12.0, 25.0))
    still = law_of("macro", "operational_space", "controller.feedforward=false")
    assert law_cache_key(law) == law_cache_key(other) != law_cache_key(still)
    config = configured("macro", "operational_space", "controller.natural_frequency=25.0")
    measured = states(config.arm.model, config.arm.home)
    compiled_torques(law, measured)
    monkeypatch.setattr("runner.assembly.compiled.commands.Expressed", None)  # nothing is expressed any more
    assert_agree(other, other, measured)


def test_a_singular_posture_without_damping_is_the_same_error():
    law = law_of("macro", "operational_space", "controller.singularity_damping=0")
    folded, reference = np.array([0.0, 0.0, np.pi / 2]), np.array([[0.1, 0.2, 0.3], [0.0] * 3, [0.0] * 3])
    with pytest.raises(np.linalg.LinAlgError, match="the tip's Jacobian is singular"):
        law.torque(0.0, folded, np.zeros(3), reference)
    with pytest.raises(np.linalg.LinAlgError, match="the tip's Jacobian is singular"):
        compiled_torques(law, [(folded, np.zeros(3), reference)])


class Gains(NamedTuple):
    stiffness: Any
    damping: Any


class Transposed(TorqueLaw[Gains]):
    """A law of a user's: a spring to the goal, with a term that a test can change."""

    bias = 1.0

    def evaluate(self, arms, parameters, time, q, dq, reference, state):
        (arm,) = arms
        tip = arm.tip(q, dq)
        pull = parameters.stiffness * (reference[0] - tip.x)
        return self.bias * tip.J[:3].T.dot(pull) - parameters.damping * dq + arm.inverse_dynamics(
            q, 0.0 * dq, 0.0 * dq
        ), state


class Mutated(Transposed):
    bias = 1.001


class Stubborn(Transposed):
    def evaluate(self, arms, parameters, time, q, dq, reference, state):
        return np.array([float(entry) for entry in q]), state


class Branching(Transposed):
    def evaluate(self, arms, parameters, time, q, dq, reference, state):
        torque, state = super().evaluate(arms, parameters, time, q, dq, reference, state)
        return (0.0 * torque if reference[1][0] == 0.0 else torque), state


class Integrating(Transposed):
    total = 0.0

    def evaluate(self, arms, parameters, time, q, dq, reference, state):
        torque, state = super().evaluate(arms, parameters, time, q, dq, reference, state)
        self.total = self.total + q[0]
        return torque - self.total, state


CALLS = []


class Counting(Transposed):
    def evaluate(self, arms, parameters, time, q, dq, reference, state):
        torque, state = super().evaluate(arms, parameters, time, q, dq, reference, state)
        CALLS.append(time)
        return float(len(CALLS)) * torque, state


def users_law(kind):
    config = configured("macro", "operational_space")
    return kind([config.arm.model], True, Gains(120.0, 7.0)), states(config.arm.model, config.arm.home)


def test_a_law_of_a_user_s_is_compiled():
    law, measured = users_law(Transposed)
    assert_agree(law, law, measured)


def found(controller, joints=3):
    """Return the compiled commands of a loop with a controller."""
    law = unguarded(controller)
    robot = SimpleNamespace(model=law.models[0], stages=(None,))
    exact = EncoderNoise(*np.zeros((3, joints)), "none", "exact")
    loop = Loop("whole", slice(0, joints), 0.01, controller)
    timing, limits = SimpleNamespace(tick=0.01), TorqueLimits.constant(np.full(joints, np.inf))
    config = SimpleNamespace(
        arm=robot, ignore_base_rotation=False, timing=timing, encoder_noise=exact, torque_limits=limits, interpreted=[]
    )
    return loops.find_commands(config, [loop])


def test_a_guarded_law_of_a_user_s_is_compiled_and_guarded_and_its_code_is_not_kept(code_cache):
    program._program.cache_clear()
    law, _ = users_law(Transposed)
    run = CompiledLoops(loops.compiled(found(guard_law(law, 3))), 1, [np.zeros((1, 3))])
    run.start(np.zeros(1), np.zeros((1, 3, 3)), None, np.zeros(3))
    assert list(code_cache.iterdir()) == []
    with pytest.raises(SimulationError, match=r"Transposed.evaluate .* gave nan at index \[0\]; it must be finite"):
        run.update(0, np.full(3, np.nan), np.zeros(3))


def test_a_mutated_term_is_caught():
    (law, measured), (other, _) = users_law(Transposed), users_law(Mutated)
    with pytest.raises(AssertionError):
        assert_agree(law, other, measured)


def test_a_law_that_cannot_be_compiled_says_why_once_and_runs_as_it_is(capsys):
    law, measured = users_law(Stubborn)
    loops._tell.cache_clear()
    with pytest.raises(CannotCompileError, match="does what expressions cannot do"):
        compiled_torques(law, measured)
    assert [loops.compiled(found(law)) for _ in range(2)] == [None, None]
    said = capsys.readouterr().err.splitlines()
    assert [line for line in said if "not compiled" in line] == [
        line for line in said if line.startswith("runner: Stubborn is not compiled, and runs through Pinocchio: ")
    ]
    assert sum("not compiled" in line for line in said) == 1


@pytest.mark.parametrize(
    ("kind", "reason"),
    [
        (Branching, "it compares values: use backend.equal"),
        (Integrating, "it changes total; keep that in the state"),
        (Counting, "a second call gives something else; keep what changes in the state"),
    ],
)
def test_a_law_whose_code_would_compute_something_else_is_not_compiled(kind, reason):
    law, measured = users_law(kind)
    with pytest.raises(CannotCompileError, match=reason):
        compiled_torques(law, measured)
    assert vars(law).keys() == vars(users_law(Transposed)[0]).keys()


def test_a_law_that_keeps_something_unknown_is_not_compiled():
    law, measured = users_law(Transposed)
    law.helper = print
    with pytest.raises(CannotCompileError, match="keeps helper"):
        compiled_torques(law, measured)


def test_arms_of_many_joints_run_through_pinocchio(capsys):
    loops._tell.cache_clear()
    law = law_of("snake", "operational_space")
    assert found(law, 30) is None
    assert compiled_motion.CompiledStep.compile(law.models[0], 0.01) is None
    assert "the arm has 30 joints" in capsys.readouterr().err


def test_without_the_library_laws_run_as_they_are(monkeypatch):
    monkeypatch.setattr(loops, "evaluator", dict)
    monkeypatch.setattr(compiled_motion, "evaluator", dict)
    law = law_of("macro", "operational_space")
    assert found(law) is None
    assert compiled_motion.CompiledStep.compile(law.models[0], 0.01) is None


def test_a_law_without_a_hash_has_a_key():
    law = copy(law_of("macro", "computed_torque"))

    class Compared(type(law)):
        __hash__ = None

    law.__class__ = Compared
    assert "Compared" in law_cache_key(law)
