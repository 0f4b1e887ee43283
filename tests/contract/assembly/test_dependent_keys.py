"""Keys that depend on another key: rejected where they contradict the run, named where they have no effect."""

import pytest
from support import strangers
from support.strangers import Y, Z

from runner.assembly.dependent_keys import depends, idle_keys

IDEAL = ("robot=xarm7", "controller=differential_inverse_kinematics", "plant=kinematic")
ARM = ("robot=macro", "trajectory=quintic")
SENSOR = (
    "controller.sensor={range:[9,9,9,9,9,9],resolution:[0,0,0,0,0,0],noise:[0,0,0,0,0,0],bias:[0,0,0,0,0,0],"
    "drift:[0,0,0,0,0,0],low_pass:null,rotation:0.1,height:0.01,mass:0.0}"
)
IDLE = [
    (IDEAL, "mismatch.mass=1.3", "plant=kinematic"),
    (IDEAL, "mismatch.gravity=0.9", "plant=kinematic"),
    (IDEAL, "mismatch.payload=1", "plant=kinematic"),
    (IDEAL, "mismatch.spread=0.1", "plant=kinematic"),
    (IDEAL, "mismatch.centre_of_mass=0.9", "plant=kinematic"),
    (IDEAL, "mismatch=sampled", "plant=kinematic"),
    (IDEAL, "noise.velocity=low_pass", "controller=differential_inverse_kinematics"),
    (ARM, "endpoint_sensor.noise=1e-3", "endpoint_sensor.read_by"),
    ((*ARM, "endpoint_sensor.read_by=[macro]"), "endpoint_sensor.velocity_bandwidth=99", "endpoint_sensor.velocity"),
    (ARM, "joint_torque_sensor=ideal", "disturbance_observer.torque"),
    (ARM, "joint_torque_sensor.bias=1", "joint_torque_sensor.noise"),
    (ARM, "wrist_sensor.noise=[1,1,1,1,1,1]", "environment=free"),
    (ARM, "disturbance_observer.torque=measured", "disturbance_observer.bandwidth"),
    (ARM, "noise.velocity_bandwidth=100", "noise.velocity=exact"),
    (ARM, "noise.distribution=gaussian", "noise.position"),
    ((*ARM, "noise.distribution=none"), "noise.position=1e-3", "noise.distribution"),
    ((*ARM, "environment=push", "environment.noise=5"), "environment.bandwidth=5000", "controller.period"),
    ((*ARM, "environment=push", "environment.noise=0"), "environment.bandwidth=5", "environment.noise"),
    ((*ARM, "environment=push", "environment.force=[0,0,0]"), "environment.frequency=5", "environment.force"),
    (ARM, "robot.friction.stribeck_speed=0.1", "friction.static"),
    (ARM, "plant.friction.stribeck_curve=exponential", "friction.static"),
    ((*ARM, "robot.friction.static=2"), "robot.friction.stribeck_curve=exponential", "friction.stribeck_speed"),
    (ARM, "robot.friction.sigmoid.level=3", "friction.sigmoid.steepness"),
    (ARM, "robot.friction.sigmoid={level:3}", "friction.sigmoid.steepness"),
    (ARM, "plant.servo.stiffness=10", "controller=operational_space"),
    (ARM, "plant.dynamics=decoupled", "robot=macro"),
    (("robot=combined",), "controller.damping_gain=5", "controller.coupling"),
    (("robot=mini", "controller=hybrid_force"), "controller.feedforward=false", "trajectory.kind=goal"),
    (("robot=meca500", "controller=admittance"), "controller.check_stability=false", "environment"),
    (("robot=meca500", "controller=admittance", "plant=rk4"), "controller.check_stability=false", "plant=rk4"),
    (("robot=meca500", "controller=admittance", SENSOR), "++controller.sensor.low_pass=20", "controller.sensor"),
    (ARM, "robot.path_size=0.1", "${robot.path_size}"),
    (ARM, "preset.macro_target=tip_goal", "${preset.macro_target}"),
]  # fmt: skip


@pytest.mark.parametrize(("run", "override", "on"), IDLE, ids=[override for _, override, _ in IDLE])
def test_a_key_without_effect_is_told_with_the_key_on_which_it_depends(checked_config, run, override, on):
    key = override.partition("=")[0].lstrip("+").removesuffix("={level:3}")
    (line,) = [line for line in idle_keys(checked_config(*run, override)) if line.startswith((key, override))]
    assert ": no effect, because " in line
    assert on in line.partition("because")[2]
    assert depends(key)


ACTING = [
    (IDEAL, "mismatch.length=1.1"),
    (("robot=xarm7", "controller=differential_inverse_kinematics", "plant=rk4"), "mismatch.mass=1.3"),
    (("robot=xarm7", "controller=differential_inverse_kinematics", "plant=rk4"), "plant.servo.stiffness=10"),
    ((*ARM, "plant=mujoco"), "plant_error=true"),
    ((*ARM, "endpoint_sensor.read_by=[macro]"), "endpoint_sensor.noise=1e-3"),
    ((*ARM, "disturbance_observer=momentum", "disturbance_observer.torque=measured"), "joint_torque_sensor=ideal"),
    ((*ARM, "environment=push"), "wrist_sensor.noise=[1,1,1,1,1,1]"),
    (ARM, "wrist_sensor=mini40"),  # by its mass
    (ARM, "wrist_sensor.mass=0.1"),
    ((*ARM, "noise.velocity=luenberger"), "noise.velocity_bandwidth=100"),
    ((*ARM, "noise.position=1e-3"), "noise.distribution=gaussian"),
    ((*ARM, "environment=push", "environment.noise=5"), "environment.bandwidth=50"),
    ((*ARM, "robot.friction.static=2", "robot.friction.stribeck_speed=1"), "robot.friction.stribeck_curve=exponential"),
    ((*ARM, "robot.friction.sigmoid.steepness=30"), "robot.friction.sigmoid.level=3"),
    (("robot=combined",), "plant.dynamics=decoupled"),
    (("robot=combined", "controller.coupling=inertial_damping"), "controller.damping_gain=5"),
    (("robot=mini", "controller=hybrid_force", "trajectory=quintic"), "controller.feedforward=false"),
    (("robot=meca500", "controller=admittance", "environment=wall"), "controller.check_stability=false"),
    (("robot=meca500", "controller=admittance", SENSOR), "++controller.sensor.bias=[1,0,0,0,0,0]"),
    (ARM, "robot.goal=[0.3,0.1,0.3]"),
    ((*ARM, "trajectory.goal='${robot.start}'", "robot.goal=[0.3,0.1,0.3]"), "robot.start=[0.5,0,0.2]"),
]  # fmt: skip


@pytest.mark.parametrize(("run", "override"), ACTING, ids=[override for _, override in ACTING])
def test_a_key_that_acts_is_not_told(checked_config, run, override):
    key = override.partition("=")[0].lstrip("+")
    assert [line for line in idle_keys(checked_config(*run, override)) if line.startswith(key)] == []


def test_an_ordinary_run_says_nothing_new(checked_config):
    for robot in ("macro", "combined", "xarm7", "meca500", "panda"):
        assert (
            idle_keys(checked_config(f"robot={robot}", "noise=thesis", "torque_limits=none", "preset=as_reported"))
            == []
        )


FRICTION = ["viscous=20.5", "coulomb=2.5", "static=[1.5,1.5,1.5]", "sigmoid.level=3.5"]
LINKS = ("robot=macro", "plant=rk4_flexible_links", "trajectory=quintic")
KINEMATIC = ("robot=macro", "controller=differential_inverse_kinematics", "plant=kinematic")


@pytest.mark.parametrize("run", [LINKS, KINEMATIC], ids=["flexible_links", "kinematic"])
@pytest.mark.parametrize("key", FRICTION)
def test_friction_of_a_plant_without_it_is_rejected(cli, run, key):
    extra = ["robot.friction.sigmoid.steepness=9"] if "sigmoid" in key else []
    ending = cli(*run, f"robot.friction.{key}", *extra, "duration=0.1")
    name, value = key.split("=")
    assert ending.code == 2
    plant = run[1] if "plant" in run[1] else run[2]
    expected = (
        f"robot.friction.{name}: {value.replace(',', ', ')} found, and {plant} has no joint friction. Take a plant"
    )
    assert expected in ending.err, ending.err


def test_no_friction_contradicts_no_plant(checked_config):
    checked_config(*LINKS, "robot.friction.viscous=0", "robot.friction.stribeck_speed=1")


def test_friction_of_a_robot_file_is_told_once_and_not_rejected(cli, tmp_path):
    joints = [("revolute", Z), ("revolute", Y), ("revolute", Y)]
    (tmp_path / "own" / "robot").mkdir(parents=True)
    (tmp_path / "own" / "arm.urdf").write_text(strangers.chain("arm", joints, tip=(0.1, 0.0, 0.25)))
    (tmp_path / "own" / "robot" / "arm.yaml").write_text(
        "# @package _global_\n# An arm\ndefaults: [override /controller: differential_inverse_kinematics]\n"
        "robot: {name: arm, urdf: arm.urdf, tip: tip, home: [0.2, 0.4, 0.5], goal: [0.3, 0.1, 0.5],\n"
        "  friction: {viscous: 2.0, coulomb: 1.0, stribeck_speed: 0.1}}\n"
    )
    ending = cli("--config-dir", tmp_path / "own", "robot=arm", "plant=kinematic", "duration=0.05")
    assert ending.code == 0
    assert ending.err.count("friction") == 2
    assert "warning: robot.friction: no effect, because plant=kinematic has no joint friction\n" in ending.err


def test_an_experiment_counts_as_the_command_line(checked_config, tmp_path, cli):
    (tmp_path / "own" / "experiment").mkdir(parents=True)
    own = tmp_path / "own" / "experiment" / "rough.yaml"
    own.write_text(
        "# @package _global_\n# Rough\nrobot: {friction: {viscous: 20.0}}\nnoise: {velocity_bandwidth: 9.0}\n"
    )
    ending = cli("--config-dir", tmp_path / "own", "robot=macro", "experiment=rough", "duration=0.05")
    assert ending.code == 0
    assert "warning: noise.velocity_bandwidth: no effect, because noise.velocity=exact has no bandwidth" in ending.err
    ending = cli("--config-dir", tmp_path / "own", *LINKS, "experiment=rough")
    assert ending.code == 2
    assert "robot.friction.viscous: 20.0 found, and plant=rk4_flexible_links has no joint friction" in ending.err


def test_a_sweep_tells_in_how_many_cells_a_key_has_no_effect(cli):
    few = ("-m", *ARM, "duration=0.05")
    ending = cli(*few, "noise.velocity=exact,low_pass", "noise.velocity_bandwidth=90,100")
    assert (
        "warning: noise.velocity_bandwidth: no effect, because noise.velocity=exact has no bandwidth (2 of 4"
        in ending.err
    )
    ending = cli(*few, "noise.velocity_bandwidth=90,100")
    assert ending.err.count("noise.velocity=exact has no bandwidth\n") == 1
    assert "no effect" not in cli(*few, "noise.velocity=exact,low_pass").err


def test_one_run_tells_that_it_sweeps_nothing(cli):
    ending = cli("experiment=sweep/frequency_period", "duration=0.05", "repetitions=1")
    swept = "controller.natural_frequency, controller.period not swept, because one run is made; add -m"
    assert f"warning: experiment=sweep/frequency_period: {swept}\n" in ending.err
    listed = "experiment=[sweep/frequency_period,thesis/figure_3_5]"
    assert f"warning: {listed}: {swept}\n" in cli(listed, "--dry-run").err
    ending = cli(*ARM, "sweep.time_limit=9", "duration=0.05")
    assert "warning: sweep.time_limit: no effect, because one run is made; add -m\n" in ending.err
