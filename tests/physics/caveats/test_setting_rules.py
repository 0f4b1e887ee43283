"""Caveats of a config: load, measurements, nominal model, gains, duration, and the robot's file."""

from textwrap import dedent

import pytest
from support.caveat_runs import found, signals
from support.engines import ASKED
from support.mjcf_arms import CHAIN, written

from runner.assembly.validation import validate
from runner.caveats.monitor import Watch
from runner.caveats.setting import setting_of
from runner.config.compose.compose import compose
from runner.robots.mjcf import read_mjcf


@pytest.mark.parametrize(
    ("overrides", "rule", "text"),
    [
        (("robot=xarm7", "robot.payload.mass=3.5"), None, ""),
        (
            ("robot=xarm7", "robot.payload.mass=7"),
            "overload",
            "the payload weighs 7 kg, 2 times the 3.5 kg that xarm7 is rated for",
        ),
        (
            ("robot=meca500", "robot.tool.mass=0.7", "robot.payload.mass=0.05"),
            "overload",
            "tool and payload weigh 0.75 kg, 1.5 times the 0.5 kg that meca500 is rated for",
        ),
        (("robot=xarm7", "robot.payload.mass=7", "caveats.overload.share=2"), None, ""),
        (
            ("robot=macro", "robot.payload.mass=500"),
            "no_effort_limit",
            "macro lifts 500 kg, and would lift anything: no joint has a torque limit",
        ),
        (("robot=macro", "robot.payload.mass=500", "torque_limits.max=50"), None, ""),
        (("robot=macro", "robot.payload.mass=1", "caveats.no_effort_limit.payload=1"), None, ""),
    ],
)
def test_what_an_arm_carries(checked_config, overrides, rule, text):
    caveats = found(checked_config(*overrides))
    assert list(caveats) == ([rule] if rule else [])
    assert not rule or caveats[rule].text == text


NOISY = ("robot=macro", "noise.position=1e-3")


@pytest.mark.parametrize(
    ("overrides", "value"),
    [
        (NOISY, 1e-3),
        (("robot=macro", "noise.resolution=1e-4"), 1e-4),
        ((*NOISY, "noise.velocity=finite_difference"), None),
        (("robot=macro",), None),
        (("robot=macro", "noise.bias=1e-3"), None),  # a velocity does not see a zero that is set wrong
        ((*NOISY, "noise.distribution=none"), None),
        ((*NOISY, "caveats.exact_velocity.noise=1e-3"), None),
        (("robot=xarm7", "noise.position=1e-3"), None),  # it commands positions, and takes no velocities
    ],
)
def test_exact_velocities_beside_noisy_positions(checked_config, overrides, value):
    caveat = found(checked_config(*overrides)).get("exact_velocity")
    assert value == (caveat and caveat.value)
    if caveat:
        assert "noise.velocity: exact" in caveat.text


@pytest.mark.parametrize(
    ("overrides", "value"),
    [
        (("mismatch.mass=1.2", "repetitions=20"), 0.2),
        (("mismatch.gravity=0.9", "mismatch.length=1.01", "repetitions=2"), 0.1),
        (("mismatch.payload=0.5", "repetitions=2"), 0.25),  # on links of 2 kg
        (("mismatch.mass=1.2", "repetitions=1"), None),
        (("mismatch.link.link2.inertia=1.3", "repetitions=2"), 0.3),
        (("mismatch.link.link2={mass: 1.2, inertia_spread: 0.1}", "repetitions=2"), None),
        (("mismatch.mass=1.2", "mismatch.spread=0.1", "repetitions=20"), None),
        (("repetitions=20",), None),
        (("mismatch.mass=1.2", "repetitions=20", "caveats.fixed_mismatch.error=0.3"), None),
    ],
)
def test_repetitions_that_vary_noise_alone(checked_config, overrides, value):
    config = checked_config("robot=macro", ASKED, *overrides)
    caveats = {caveat.rule: caveat for caveat in Watch(setting_of(config), config.caveats).found().caveats}
    if value is None:
        assert caveats == {}
    else:
        assert caveats["fixed_mismatch"].value == pytest.approx(value)


def test_all_that_is_wrong_is_named(checked_config):
    config = checked_config("robot=macro", "mismatch.gravity=0.9", "mismatch.payload=1", "repetitions=2")
    text = found(config, signals(), signals())["fixed_mismatch"].text
    assert text.startswith("the 2 repetitions vary only noise: mismatch.gravity, mismatch.payload are the same in all")


LINE = ("robot=xarm7", "trajectory=joint_quintic", "trajectory.goal_configuration=[0.4,-0.3,0.3,0.4,-0.3,0.3,0.4]",
        "controller.period=0.001", "controller.natural_frequency=30")  # fmt: skip


def test_light_joints_that_move_others_are_told_the_bound(checked_config):
    """Without rotors joint PD is unstable along this motion, and chatters."""
    told = found(checked_config(*LINE, "controller=joint_pd"))["unstable_gains"]
    assert told.value == pytest.approx(5.64, abs=0.01)
    assert "or controller.period is at least 5.64 times too large" in told.text
    assert "robot.armature" in told.text
    assert "lambda_max(M^-1 diag M) is 188" in told.text


def test_a_law_of_the_whole_mass_matrix_is_told_its_own(checked_config):
    told = found(checked_config(*LINE, "controller=computed_torque", "controller.natural_frequency=1200"))
    assert told["unstable_gains"].value == pytest.approx(1.2)
    assert "armature" not in told["unstable_gains"].text


QUIET = [
    ("controller=computed_torque",),
    ("controller=joint_pd", "robot.armature=assumed"),
    ("controller=joint_pd", "caveats.unstable_gains.share=6"),
]


@pytest.mark.parametrize("more", QUIET)
def test_other_laws_have_no_caveat_of_gains(checked_config, more):
    assert "unstable_gains" not in found(checked_config(*LINE, *more))


OBSERVED = ("robot=macro", "controller=computed_torque", "disturbance_observer=momentum")
SLOW = (*OBSERVED, "disturbance_observer.bandwidth=1.5")


def test_a_run_of_less_than_three_time_constants_is_told(checked_config):
    told = found(checked_config(*SLOW, "duration=1.6"))["short_horizon"]
    assert told.value == pytest.approx(2.0 / 1.6)
    assert told.text == (
        "the law's disturbance observer has a time constant of 0.667 s, and the run ends after 1.6 s: it is judged "
        "before it has done its work, which takes 3 time constants; take duration=2 or more"
    )


ENOUGH = [
    (*SLOW, "duration=2"),
    (*SLOW, "duration=1.6", "caveats.short_horizon.share=1.3"),
    (*OBSERVED, "duration=0.1"),  # three times 1 / 30 s
    ("robot=macro", "controller=impedance", "duration=0.01"),  # says no time constant
]


@pytest.mark.parametrize("overrides", ENOUGH)
def test_others_are_not(checked_config, overrides):
    assert "short_horizon" not in found(checked_config(*overrides))


def test_the_duration_that_is_named_is_enough(checked_config):
    short = ("robot=macro", "controller=adaptive", "trajectory=circle", "trajectory.duration=2")
    text = found(checked_config(*short, "controller.adaptation_gain=0.1"))["short_horizon"].text
    duration = text.partition("take duration=")[2].split()[0]
    longer = found(checked_config(*short, "controller.adaptation_gain=0.1", f"duration={duration}"))
    assert "short_horizon" not in longer


def test_a_run_stores_it_and_its_threshold(make_run):
    run = make_run("robot=macro", "duration=0.05", "caveats.short_horizon.share=1.5")
    assert {caveat["rule"]: caveat["value"] for caveat in run.caveats}["short_horizon"] == pytest.approx(2.0)
    assert run.caveat_rules["thresholds"]["short_horizon"] == {"share": 1.5}


ROBOT = """\
# @package _global_
# A user's arm
defaults: [{override /controller: operational_space}, {override /trajectory: quintic}]
robot: {name: elbow, FORMAT: FILE, tip: tcp, home: [0.0, 0.5, 1.0], goal: [0.4, 0.2, 0.2]}
"""
HELD = CHAIN.replace('name="q1"', 'name="q1" damping="2" armature="0.1"').replace(
    'name="q3"', 'name="q3" damping="3" frictionloss="0.5"'
)
MOON = CHAIN.replace("<default>", '<option gravity="0 0 -1.62" density="1.2"/><default>')


@pytest.fixture(params=["mjcf", "urdf"])
def told(request, tmp_path):
    """Return the rule's caveat on a run of an MJCF, or of the URDF made from it; None without a caveat."""

    def run(text, *overrides):
        path = written(tmp_path, text)
        file = path.name if request.param == "mjcf" else "arm.urdf"
        if request.param == "urdf":
            written(tmp_path, read_mjcf(path).urdf, file)
        written(tmp_path, dedent(ROBOT).replace("FORMAT", request.param).replace("FILE", file), "robot/elbow.yaml")
        composed = compose(["robot=elbow", "duration=0.1", "trajectory.duration=0.1", *overrides], [tmp_path])
        caveat = found(validate(composed)).get("robot_file")
        return caveat and caveat.text.replace(file, "FILE")

    return run


def test_a_run_says_what_its_file_holds_and_it_has_not(told):
    damping, friction, armature = (
        "damping (robot.friction.viscous): 2 (q1), 3 (q3)",
        "friction (robot.friction.coulomb): 0.5 (q3)",
        "armature (robot.armature): 0.1 (q1)",
    )
    assert told(HELD) == f"not taken from FILE: {damping}; {friction}; {armature}"
    assert told(HELD, "robot.friction.viscous=[2,0,3]", "robot.armature=0.1") == f"not taken from FILE: {friction}"
    given = "damping (robot.friction.viscous): 3 (q3)"
    assert told(HELD, "plant.friction.viscous=[1,0,0]", "plant.friction.coulomb=1", "robot.armature=[1,0,0]") == (
        f"not taken from FILE: {given}"
    )
    assert told(HELD, "caveats.robot_file.left_out=3") is None


def test_it_says_nothing_of_what_the_run_has(told):
    assert told(CHAIN) is None
    assert told(HELD, "robot.friction.viscous=1", "robot.friction.coulomb=1", "robot.armature=1") is None


def test_no_force_moves_joints_that_follow_exactly(told):
    assert told(HELD, "plant=kinematic", "controller=differential_inverse_kinematics") is None


def test_motors_of_flexible_joints_are_their_armature(told):
    given = ("robot.friction.viscous=1", "robot.friction.coulomb=1")
    assert told(HELD, "plant=rk4_flexible", *given) is None


def test_gravity_and_air_are_told_and_gravity_that_is_given_is_not(told):
    air = "density of the air of 1.2 in SI units"
    assert told(MOON) == f"not taken from FILE: gravity of 0, 0, -1.62 m/s^2 (gravity, along -z); {air}"
    assert told(MOON, "gravity=1.62") == f"not taken from FILE: {air}"
