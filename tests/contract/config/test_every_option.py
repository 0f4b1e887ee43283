"""Every option that there is composes and runs, with what it does not run without."""

from itertools import zip_longest
from pathlib import Path

import pytest
from support.printed import without_caveats, without_results

from runner.config.compose.files import group_options, groups
from runner.sweeps.job import run

SWING = Path(__file__).parents[3] / "examples" / "swing.csv"


def options_of(group):
    return [f"{group}={name}" for name in group_options(group)]


GROUPS = [group for group in groups() if group not in ("calibration", "challenge")]  # of other commands
OPTIONS = [option for group in GROUPS for option in options_of(group)]
BESIDE = ("noise", "torque_limits", "mismatch", "wrist_sensor", "joint_torque_sensor", "endpoint_sensor",
          "disturbance_observer", "notch", "preset", "spec")  # fmt: skip
LOOP = ("controller", "trajectory", "plant", "environment", "input_shaper")
NEEDS = {  # what an option does not run without
    "controller=admittance": ("robot=meca500",),
    "controller=hybrid_force": ("robot=mini",),
    "controller=iterative_learning": (
        "robot=macro",
        "trajectory=circle",
        "trajectory.easing=none",
        "trajectory.radius=1e-4",
        "trajectory.duration=0.02",
        "duration=0.05",
    ),
    "controller=macro_mini": ("robot=combined",),
    "controller=motor_pd": ("robot=macro", "plant=rk4_flexible", "plant.flexible_joints.static_deflection=unknown"),
    "controller=three_joint": ("robot=xarm7",),
    "controller=xarm7_as_printed": ("robot=xarm7", "controller.inverse=right"),
    "environment=wall": ("robot=meca500",),
    "experiment=xarm7/as_printed": ("controller.inverse=right",),
    "input_shaper=zv": ("robot=macro", "plant=rk4_flexible"),
    "input_shaper=zvd": ("robot=macro", "plant=rk4_flexible"),
    "plant=kinematic": ("robot=xarm7",),
    "plant=bullet_flexible": ("robot=macro",),
    "plant=mujoco_flexible": ("robot=macro",),
    "plant=rk4_flexible": ("robot=macro",),
    "plant=rk4_flexible_links": ("robot=macro", "trajectory=quintic"),
    "trajectory=from_file": (f"trajectory.file={SWING}",),
    **{
        option: ("disturbance_observer=momentum", "disturbance_observer.torque=measured")
        for option in options_of("joint_torque_sensor")
        if option != "joint_torque_sensor=none"
    },
}


def free(group):
    return [option for option in options_of(group) if option not in NEEDS]


def lines():
    """Return lines that choose each option, with what it needs; options that need nothing share lines."""
    for sharing in (BESIDE, LOOP):
        yield from (tuple(filter(None, each)) for each in zip_longest(*map(free, sharing)))
    for option in OPTIONS:
        if option in NEEDS or option.partition("=")[0] not in BESIDE + LOOP:
            yield (*NEEDS.get(option, ()), option)


# Walls, and wrist sensors with a tool, on the default plant.
NEED_BULLET = ("experiment=meca500/circle", "experiment=meca500/tool_in_motion", "experiment=meca500/weighing")


@pytest.mark.parametrize(
    "line",
    [
        pytest.param(line, id=" ".join(line), marks=[pytest.mark.bullet] if set(NEED_BULLET) & set(line) else [])
        for line in lines()
    ],
)
def test_it_composes_and_runs(tmp_path, line):
    made = run(*line, "duration=0.05", "repetitions=1", f"outputs={tmp_path}")
    warnings = [each for each in made.provenance["warnings"] if ": no effect, because " not in each]
    assert (made.status, warnings) == ("ok", [])


@pytest.mark.parametrize(
    "groups", [BESIDE, LOOP, *((group,) for group in GROUPS if group not in BESIDE + LOOP)], ids=" ".join
)
def test_one_of_each_group_runs_from_the_command_line(cli, groups):
    line = [free(group)[-1] for group in groups]
    ending = cli(*line, "duration=0.05", "repetitions=1")
    assert (ending.code, without_caveats(without_results(ending.err))) == (0, "")
