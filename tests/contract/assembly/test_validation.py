"""Bad values: each ends with exit code 2 and one message that says how to fix it, and leaves nothing behind."""

import pytest

from runner.assembly.validation import validate
from runner.base.errors import ConfigError
from runner.config.compose.compose import compose

KEYS = "keys: kind, position, distribution, bias, resolution, velocity"
ABOVE_ZERO = "must be a number above 0, or a list of such numbers with one for each joint"


@pytest.mark.parametrize(
    ("overrides", "problem"),
    [
        ("controler=x", "controler: unknown key (did you mean controller?); keys: seed, repetitions, duration, "),
        ("noise.positon=1", f"noise.positon: unknown key (did you mean position?); {KEYS}"),
        ("+noise.extra=1", f"noise.extra: unknown key; {KEYS}"),
        ("~noise", "noise: must be a group of keys; found None"),
        ("~noise.velocity", "noise.velocity: missing"),
        ("~plant.kind", "plant.kind: missing; known: bullet, "),
        ("environment.kind=10", "environment.kind: '10' is unknown; known: free, "),
        ("plant.kind=bulet", "plant.kind: 'bulet' is unknown (did you mean bullet?); known: bullet, "),
        (
            "noise.velocity=exakt",
            "noise.velocity: found 'exakt' (did you mean exact?); allowed: exact, finite_difference",
        ),
        ("seed=abc", "seed: must be a whole number; found 'abc'"),
        ("seed=-1", "seed: must be 0 or more; found -1"),
        ("repetitions=1.5", "repetitions: must be a whole number; found 1.5"),
        ("repetitions=0", "repetitions: must be above 0; found 0"),
        ("duration=0", "duration: must be above 0; found 0"),
        ("duration=1e-9", "duration: 1e-09 s is shorter than one controller period, 0.01 s"),
        (
            "duration=1e9",
            "limits.memory: a run of 1e+09 s (1e+11 ticks of 0.01 s, repetitions: 1) would take about 5.04e+04",
        ),
        ("trajectory=quintic trajectory.duration=1e9", "limits.memory: a run of 1e+09 s (1e+11 ticks of 0.01 s"),
        ("trajectory=quintic trajectory.duration=0", "trajectory.duration: must be above 0; found 0"),
        ("outputs=", "outputs: must not be empty; found ''"),
        ("outputs=3", "outputs: must be a string; found 3"),
        ("controller.feedforward=1", "controller.feedforward: must be true or false; found 1"),
        ("controller.period=0", "controller.period: must be above 0; found 0"),
        ("controller.period=inf", "controller.period: must be a finite number; found inf"),
        ("controller.damping_ratio=fast", "controller.damping_ratio: must be a number; found 'fast'"),
        ("noise.position=nan", "noise.position: must be a finite number; found nan"),
        ("robot.masses.link2=-1", "robot.masses.link2: must be above 0; found -1"),
        ("robot.masses.link2=0", "robot.masses.link2: must be above 0; found 0"),
        ("robot.masses.link9=1", "robot.masses.link9: no such link (did you mean link3?); links: base, link1, "),
        ("robot.masses=3", "robot.masses: must be a group of keys; found 3"),
        ("robot.home=[0,0]", "robot.home: 2 values for 3 joints (q1, q2, q3); found [0.0, 0.0]"),
        (
            "robot=xarm7 robot.home=[0,0,0,90,0,0,0]",
            "joint4 at 90 rad is beyond its limits, -0.192 to 3.927 rad; degrees? write 90deg, which is 1.571 rad",
        ),
        ("robot.home=[0,45,0]", "robot.home: q2 at 45 rad is more than a whole turn; degrees? write 45deg\n"),
        (
            "noise.position=5",
            "noise.position: 5 rad is more than half a turn, and no measurement of an angle; degrees? ",
        ),
        (
            "noise.bias=-90",
            "noise.bias: -90 rad is more than half a turn, and no measurement of an angle; degrees? write",
        ),
        ("repetitions=1e6", "repetitions: must be a whole number; found 1000000.0; write 1000000\n"),
        ("repetitions=1.5", "repetitions: must be a whole number; found 1.5\n"),
        ("robot=xarm7 robot.home=[0,0,0,5,0,0,0]", "joint4 at 5 rad is beyond its limits, -0.192 to 3.927 rad\n"),
        (
            "robot=xarm7 robot.home=[0,0,0,9000,0,0,0]",
            "joint4 at 9000 rad is beyond its limits, -0.192 to 3.927 rad\n",
        ),
        ("robot.urdf=makro.urdf", "robot.urdf: no file 'makro.urdf' (did you mean macro.urdf?); looked in "),
        ("robot.tip=tpi", "robot.tip: no frame 'tpi' (did you mean tip?); frames: "),
        ("torque_limits.max=0", f"torque_limits.max: {ABOVE_ZERO}; found 0"),
        ("torque_limits.max=[50,-1,50]", f"torque_limits.max: {ABOVE_ZERO}; found [50, -1, 50]"),
        ("torque_limits.max=[nan,1,1]", f"torque_limits.max: {ABOVE_ZERO}; found [nan, 1, 1]"),
        ("torque_limits.max=inf", f"torque_limits.max: {ABOVE_ZERO}; found inf"),
        ("torque_limits.max=[1,2]", "torque_limits.max: 2 values for 3 joints (q1, q2, q3); found [1.0, 2.0]"),
        ("trajectory.goal=[1,2]", "trajectory.goal: must have 3 values; found 2: [1, 2]"),
        ("trajectory.goal=[nan,0,0]", "trajectory.goal.0: must be a finite number; found nan"),
        (
            "trajectory.goal=[3,3,3]",
            "trajectory.goal: [3.0, 3.0, 3.0] m is outside the workspace: 5.196 m from the shoulder, "
            "and the arm reaches 2 m",
        ),
        ("trajectory.start=[0,0,2.5]", "trajectory.start: [0.0, 0.0, 2.5] m is outside the workspace: 2.5 m from "),
        (
            "controller.period=0.0105 plant.step=0.001",
            "controller.period: 0.0105 s is not a multiple of plant.step, 0.001 s; set plant.step to the period "
            "divided by a whole number, such as 0.00105",
        ),
        ("plant.step=0.02", "controller.period: 0.01 s is not a multiple of plant.step, 0.02 s; set plant.step to "),
        ("plant.step=0", "plant.step: must be above 0; found 0"),
        ("gravity=-1", "gravity: must be 0 or more; found -1"),
    ],
)
def test_one_problem_is_said_in_one_line(cli, tmp_path, overrides, problem):
    ending = cli("robot=macro", *overrides.split())
    assert ending.code == 2
    assert ending.out == ""
    assert ending.err.startswith("runner: 1 problem in the config:\n")
    assert problem in ending.err
    assert ending.err.count("\n") == 2
    assert list(tmp_path.iterdir()) == []


def test_a_long_value_is_quoted_to_a_line(cli):
    for override in (
        f"trajectory.goal=[{','.join(['1'] * 1200)}]",
        f"noise.velocity={'x' * 5000}",
        f"{'y' * 5000}=1",
    ):
        ending = cli("robot=macro", override)
        assert ending.code == 2
        assert len(ending.err) < 3000


def test_all_problems_are_said_at_once(cli, tmp_path):
    ending = cli(
        "noise.positon=1",
        "seed=abc",
        "torque_limits.max=[1,2]",
        "trajectory.goal=[3,3,3]",
        "robot.masses.link9=1",
        "typo=1",
    )
    assert ending.code == 2
    lines = ending.err.splitlines()
    assert lines[0] == "runner: 4 problems in the config:"
    assert [line.split()[1] for line in lines[1:]] == ["typo:", "seed:", "noise.positon:", "robot.masses.link9:"]
    assert list(tmp_path.iterdir()) == []


def test_limits_and_times_are_checked_although_a_setting_is_wrong(cli):
    wrong = ("torque_limits.max=[1,2]", "plant.step=0.003")
    ending = cli("seed=abc", *wrong)
    assert [line.split()[1] for line in ending.err.splitlines()[1:]] == [
        "seed:",
        "torque_limits.max:",
        "controller.period:",
    ]


def test_start_and_goal_are_checked_together(cli):
    ending = cli("robot=macro", "trajectory=quintic", "trajectory.goal=[3,3,3]", "trajectory.start=[0,0,2.5]")
    assert [line.split()[1] for line in ending.err.splitlines()[1:]] == ["trajectory.start:", "trajectory.goal:"]


def test_the_error_holds_its_problems():
    with pytest.raises(ConfigError) as raised:
        validate(compose(["seed=-1", "repetitions=0"]))
    assert raised.value.problems == ("seed: must be 0 or more; found -1", "repetitions: must be above 0; found 0")


@pytest.mark.parametrize(
    ("overrides", "step", "steps"),
    [
        (["plant=bullet"], 0.001, 10),
        (["plant=rk4"], 0.01, 1),
        (["plant=rk4", "robot=mini"], 0.001, 1),
        (["controller.period=0.0167", "plant.step=1e-4"], 1e-4, 167),
    ],
)
def test_the_step_follows_from_the_period(overrides, step, steps):
    config = validate(compose(overrides))
    assert config.timing.step == pytest.approx(step, rel=1e-12)
    assert config.timing.steps_per_tick == steps
