"""The studies have the runs and calibrations that they had: their number, and a handful of overrides."""

import pytest

from runner.papers.study.names import study_names
from runner.papers.study.study import load_study

SOME = {
    "thesis": {
        "figure_3_9/full_equations/2.0": ("experiment=thesis/figure_3_9", "preset=full_equations",
                                          "trajectory.duration=2.0",
                                 "repetitions=5"),
        "coupling/goal/whole_body/decoupled": ("experiment=thesis/whole_body", "trajectory=goal", "repetitions=1",
                                               "noise=none", "plant.dynamics=decoupled"),
        "mass/1.75/known": ("experiment=thesis/figure_5_12", "repetitions=1", "noise=none",
                            "robot.stages.mini.masses.link2=0.875", "robot.stages.mini.masses.link3=0.875",
                            "controller.payload=known"),
        "bandwidth/bias/30.0": ("experiment=thesis/figure_5_12", "controller.payload=known", "repetitions=7",
                                "controller.natural_frequency.mini=30", "noise.bias.macro=0.001"),
        "sampling/0.95": ("experiment=thesis/sampling", "controller.period=0.0316667"),
    },
    "thesis_beyond": {
        "computing/late/1/0.3": ("experiment=thesis_beyond/computing", "controller.natural_frequency=30",
                                 "plant.computation.delay=1"),
    },
    "meca500": {
        "step/servo, 16.7 ms/rotation x": (
            "experiment=meca500/push", "controller.period=0.0167", "plant=default", "plant.servo.period=0.000835",
            "plant.step=0.000835", "environment.start_time=0.0501", "environment.force=[0.0, 0.0, 0.0]",
            "environment.moment=[0.05, 0.0, 0.0]"),
        "sine/servo, 1 ms/24.0": ("experiment=meca500/sine", "plant=default", "plant.step=0.001",
                                  "environment.frequency=24.0"),
        "rest/0": ("experiment=meca500/weighing",
                   "robot.home=[0.836651,-0.468344,-2.209594,-2.868983,1.257547,2.59342]", "wrist_sensor=mini40",
                   "seed=0"),
        "tool_centre_point/repeatability/2e-05": (
            "calibration=tool_centre_point", "calibration.posture=[0,0.2,0.3,0,1.2,0]", "calibration.spread=0.5236",
            "calibration.repeatability=2e-05", "seed=3"),
        "gravity/noise/0.25": (
            "calibration=gravity", "wrist_sensor.noise=[0.003625,0.003625,0.00725,0.000125,0.000125,0.000125]",
            "seed=22"),
        "gravity/samples/100": ("calibration=gravity", "calibration.samples=100", "seed=35"),
    },
    "engines": {
        "open/planar/MuJoCo RK4/0.0005": (
            "robot=two_links", "controller.torques=[-8,-4]", "controller=held_torques", "trajectory=goal",
            "controller.period=0.008", "duration=0.4", "plant=mujoco", "plant.integrator=rk4", "plant.step=0.0005"),
        "impact/Runge-Kutta/6.25e-05": (
            "robot=hammer", "controller.torques=[0,10]", "environment=wall", "environment.distance=0.05",
            "environment.stiffness=10000", "environment.damping=0", "duration=0.16", "plant=rk4",
            "plant.step=6.25e-05", "controller.period=6.25e-05"),
    },
    "xarm7": {
        "servo/full_equations/0.00025": ("experiment=xarm7/three_joints", "duration=5", "preset=full_equations",
                                          "plant=default",
                                "plant.step=0.00025"),
        "printed/pose/angles alone/fed back": (
            "robot=xarm7", "controller=xarm7_as_printed", "controller.task=pose", "controller.feedforward=true",
            "controller.columns=right", "controller.angles=printed", "controller.inverse=right", "controller.gain=20"),
        "rates/servos/full_equations/100": ("robot=xarm7", "plant=default", "plant.step=0.001", "plant_error=true",
                                   "preset=full_equations", "controller.period=0.01", "duration=5"),
        "payload/0.6043/asked/5": ("robot=xarm7", "robot.start=[0.6043,-0.2,0.1508]",
                                   "robot.goal=[0.6043,0.2,0.1508]", "duration=5", "robot.payload.mass=5"),
    },
    "benchmark": {
        "first/planar/passivity/circle/all/untuned": (
            "robot=planar", "controller.period=0.004", "controller=passivity", "trajectory=circle",
            "trajectory.normal=[0,1,0]", "plant.step=0.001", "trajectory.duration=2", "duration=2", "plant=rk4",
            "mismatch=sampled", "mismatch.spread=0.3", "plant.friction.coulomb=1.0", "plant.friction.viscous=0.5",
            "noise.position=1.0e-4", "noise.velocity=finite_difference", "repetitions=32"),
    },
    "precision": {
        "free/macro/PyBullet/0.002": ("robot=macro", "robot.home=[0.3,0.6,0.8]", "controller=held_torques",
                                      "controller.torques=0", "controller.period=0.008", "trajectory=goal",
                                      "duration=0.24", "plant=bullet", "plant.step=0.002"),
        "control/xarm7/Runge-Kutta/0.01": ("robot=xarm7", "controller=computed_torque", "trajectory=quintic",
                                           "trajectory.duration=1", "duration=1", "plant=rk4", "plant.step=0.01"),
    },
}  # fmt: skip


@pytest.mark.parametrize(
    ("study", "runs", "calibrations"),
    [
        ("thesis", 295, 0),
        ("thesis_beyond", 267, 0),
        ("xarm7", 121, 0),
        ("meca500", 250, 36),
        ("engines", 255, 0),
        ("precision", 90, 0),
        ("benchmark", 2444, 0),
    ],
)
def test_a_study_has_its_runs(study, runs, calibrations):
    planned = load_study(study)
    jobs, calibrated = planned.jobs(), planned.calibrations()
    assert (len(jobs), len(set(calibrated.values()))) == (runs, calibrations)  # of some names one calibration
    found = dict(jobs.items()) | dict(calibrated)
    assert {name: found[name] for name in SOME[study]} == SOME[study]


def test_every_study_is_counted():
    assert set(study_names()) == {"thesis", "thesis_beyond", "xarm7", "meca500", "engines", "precision", "benchmark"}
