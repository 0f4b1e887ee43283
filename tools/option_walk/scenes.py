"""Runs that feel options, values to which keys change, and the keys that may be without effect, with reasons."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from runner.base.paths import package_dir
from runner.config.compose.files import group_options
from runner.plugins.registry import Kinds
from runner.robots.mismatch import MISMATCHES
from runner.sensing import ENDPOINT_SENSORS, JOINT_TORQUE_SENSORS, NOISES, WRIST_SENSORS
from tools.laws import JOINT_LAWS, LAWS

ENGINES: Mapping[str, Sequence[str]] = {
    "rk4": ["plant=rk4"],
    "mujoco": ["plant=mujoco"],
    "mujoco rk4": ["plant=mujoco", "plant.integrator=rk4"],
    "bullet": ["plant=bullet"],
    "rk4_flexible": ["plant=rk4_flexible"],
    "mujoco_flexible": ["plant=mujoco_flexible"],
    "bullet_flexible": ["plant=bullet_flexible"],
    "rk4_flexible_links": ["plant=rk4_flexible_links"],
    "kinematic": ["plant=kinematic"],
}
"""Overrides of each plant."""


class Scene(NamedTuple):
    """A run that feels some keys.

    Attributes:
        overrides: Overrides of the run, on any plant.
        feels: Keys, and groups with all their keys.
        but: Keys in these groups that another scene changes.
        options: Options of groups that replace those of the run, one at a time.
    """

    overrides: str
    feels: Sequence[str]
    but: Sequence[str] = ()
    options: Sequence[str] = ()


_MOTION = package_dir().parent / "examples" / "swing.csv"
_TIP = "trajectory=quintic trajectory.duration=0.4 duration=0.06 controller.period=0.002"
_ARM = f"robot=macro {_TIP} controller=operational_space"
_LAW = f"robot=macro {_TIP}"
_SEVEN = f"robot=xarm7 {_TIP} trajectory.start=null robot.goal=[0.58,0.05,0.2] robot.armature=0.2"
_PUSH = "environment=push environment.start_time=0.01 environment.force=[3,2,5] environment.moment=[0.3,0.2,0.1]"
_TOOL = "robot.tool={mass:0.3,centre_of_mass:[0.01,0,0.03],inertia:[1e-3,1e-3,1e-3],tip:[0,0,0.05],tip_radius:0.01}"
_IDEAL = "robot=xarm7 controller=differential_inverse_kinematics trajectory=line trajectory.duration=2 duration=0.06"
_HELD = "robot=meca500 controller=admittance duration=0.06"
_FEELS = f"{_HELD} {_PUSH}"
_WALL = "controller=hybrid_force environment.distance=-1e-4 environment.friction=0.2 duration=0.03"
_SENSOR = (
    "wrist_sensor=mini40 controller.sensor={range:[20.0,20.0,60.0,1.0,1.0,1.0],resolution:[0.1,0.1,0.1,0.01,0.01,0.01],"
    "noise:[0,0,0,0,0,0],bias:[0.4,-0.3,0.8,0.01,-0.02,0.01],drift:[0,0,0,0,0,0],low_pass:null,rotation:0.3,height:0.01,"
    "mass:0.05}"
)
_ROUGH = (
    "robot.friction.viscous=1 robot.friction.coulomb=0.5 robot.friction.static=0.8 robot.friction.asymmetry=0.1 "
    "robot.friction.stribeck_speed=0.05 robot.friction.sigmoid={level:1.0,steepness:20.0,shift:0.01}"
)


def _options(*groups: str) -> list[str]:
    """Return all options of some groups, so that a new kind is in their scenes."""
    return [f"{group}={name}" for group in groups for name in group_options(group) if name != "none"]


_OWN = (
    "noise=hysteresis", "noise=shifted", "mismatch=heavier", "mismatch=lighter", *_options("noise", "mismatch")
)  # fmt: skip
_SENSORS = _options("wrist_sensor", "joint_torque_sensor")
_SENSED: Mapping[Kinds, str] = {
    NOISES: f"{_LAW} controller=computed_torque",
    MISMATCHES: f"{_LAW} controller=computed_torque",
    WRIST_SENSORS: f"{_ARM} {_PUSH}",
    JOINT_TORQUE_SENSORS: f"{_ARM} {_PUSH} disturbance_observer=momentum disturbance_observer.torque=measured",
    ENDPOINT_SENSORS: f"{_ARM} endpoint_sensor.read_by=[macro]",
}
"""Run of each further kind of a sensor, whose option has the name of the kind."""
_SHAPES = {
    "circle": "", "goal": "", "joint_quintic": "", "joint_sinusoids": "", "line": "",
    "joint_waypoints": "trajectory.configurations=[0.5,0.2,0.6,0.3]",
    "lissajous": "trajectory.amplitudes=[0.02,0.03,0.01]", "quintic": "", "square": "", "waypoints": "",
}  # fmt: skip
_FRICTION = ("robot.friction", "plant.friction")
_OF_TASK = [f"controller.{name}" for name in ("task", "null_space_frequency", "singularity_damping")]

SCENES: Mapping[str, Scene] = {
    "arm": Scene(
        f"{_ARM} robot.payload.mass=0.5 noise.position=1e-4 torque_limits.max=30",
        ["robot", "plant", "controller", "trajectory", "noise", "torque_limits", "mismatch", "gravity"],
        [*_FRICTION, "plant.servo", "robot.tool", "robot.joint_error_limit", "robot.settling_band",
         "noise.velocity_bandwidth", *_OF_TASK],
    ),
    "plain": Scene(
        "robot=macro trajectory=quintic duration=0.06 controller=computed_torque",
        ["robot.friction.viscous", "robot.friction.coulomb"],
        [],
        [*_OWN, "environment=push", "environment=hand_guiding", "environment=spring",
         "environment=sticky_wall", "controller=soft_pd", "trajectory=swing", "plant=euler", "notch=torques",
         "disturbance_observer=momentum", "torque_limits=thesis"],
    ),
    "ideal": Scene(
        f"{_IDEAL} noise.position=1e-4 robot.payload.mass=0.5",
        ["controller", "trajectory", "robot", "plant", "mismatch", "noise", "torque_limits"],
        _FRICTION,
    ),
    "plain ideal": Scene(
        _IDEAL,
        ["robot.friction.viscous", "robot.friction.coulomb", "robot.velocity_limits"],
        [],
        [*_OWN, "trajectory=swing", "environment=push", "environment=spring", "plant=euler"],
    ),
    "estimated": Scene(f"{_ARM} noise.position=1e-4 noise.velocity=low_pass", ["noise"]),
    "friction": Scene(f"{_ARM} {_ROUGH}", _FRICTION),
    "servos": Scene(f"{_IDEAL} plant.servo.stiffness=500", ["plant.servo"]),
    "stages": Scene(
        "robot=combined trajectory=quintic trajectory.duration=0.4 duration=0.03 torque_limits.max={macro:40,mini:20}",
        ["controller", "plant.dynamics", "plant.wrist_rotation", "torque_limits", "disturbance_observer", "noise"],
        ["noise.velocity_bandwidth", "controller.beyond_reach"],
        ["disturbance_observer=momentum"],
    ),
    "stages out of reach": Scene(
        "robot=combined trajectory=quintic trajectory.duration=0.4 duration=0.03 controller.reach=0.01",
        ["controller.beyond_reach"],
    ),
    "damped stages": Scene(
        "robot=combined trajectory=quintic trajectory.duration=0.4 duration=0.03 controller.coupling=inertial_damping",
        ["controller.damping_gain"],
    ),
    "whole body": Scene(
        "robot=combined controller=whole_body trajectory=quintic duration=0.03", ["controller"],
        ["controller.max_tip_speed"],
    ),
    "whole body to a goal": Scene(
        "robot=combined controller=whole_body trajectory=goal duration=0.03", ["controller.max_tip_speed"]
    ),
    **{
        law: Scene(f"{_LAW} controller={law} noise.position=1e-4", ["controller"], _OF_TASK)
        for law in JOINT_LAWS
    },
    "joint_pid": Scene(
        f"{_LAW} controller=joint_pid torque_limits.max=2 noise.position=1e-3", ["controller"], _OF_TASK
    ),
    **{
        f"seven joints by {law}": Scene(f"{_SEVEN} controller={law}", _OF_TASK)
        for law, its in LAWS.items() if {*_OF_TASK} <= {f"controller.{key}" for key in its.keys} and not its.flexible
    },
    "seven joints by motor_pd": Scene(
        f"{_SEVEN} robot.armature=0 controller=motor_pd plant.flexible_joints.static_deflection=unknown", _OF_TASK
    ),
    "impedance": Scene(f"{_SEVEN} controller=impedance {_PUSH}", ["controller"]),
    "motor_pd": Scene(
        f"{_LAW} controller=motor_pd plant.flexible_joints.static_deflection=unknown", ["controller"], _OF_TASK
    ),
    "learning": Scene(
        "robot=macro controller=iterative_learning trajectory=circle trajectory.easing=none trajectory.radius=1e-4 "
        "trajectory.duration=0.02 controller.period=0.002 duration=0.06", ["controller"], _OF_TASK
    ),
    "observer": Scene(
        f"{_ARM} disturbance_observer=momentum {_PUSH} disturbance_observer.torque=measured joint_torque_sensor=ideal",
        ["disturbance_observer", "joint_torque_sensor", "environment"],
        ["environment.bandwidth"],
        ["joint_torque_sensor=weak", "wrist_sensor=doubled", *_SENSORS],
    ),
    "shaken": Scene(f"{_ARM} {_PUSH} environment.noise=3 environment.bandwidth=50", ["environment"]),
    "guided": Scene(f"{_HELD} environment=hand_guiding environment.start_time=0.01", ["environment"]),
    "felt": Scene(
        f"{_FEELS} {_TOOL} wrist_sensor=mini40",
        ["controller", "wrist_sensor", "robot.tool", "mismatch", "noise"],
        ["controller.check_stability", "controller.tip_speed", "controller.limit_approach", "robot.tool.tip_radius",
         "controller.sensor", "noise.velocity_bandwidth"],
    ),
    "felt by an own sensor": Scene(f"{_FEELS} {_TOOL} {_SENSOR}", ["controller.sensor"]),
    "to a far goal": Scene(f"{_HELD} trajectory=goal", ["controller.tip_speed", "controller.limit_approach"]),
    "bouncing": Scene(
        f"{_HELD} {_TOOL} environment=wall environment.stiffness=1e6 environment.distance=-1e-4 "
        "controller.check_stability=false",
        ["controller.check_stability", "robot.tool.tip_radius"],
    ),
    "wall": Scene(
        f"robot=mini {_WALL}",
        ["controller", "environment"],
        ["controller.actuated_stages", "controller.sensor"],
        ["environment=sticky_wall"],
    ),
    "wall with an own sensor": Scene(f"{_WALL} {_SENSOR}", ["controller.sensor"]),
    "along the wall": Scene(f"robot=mini {_WALL} trajectory=quintic", ["controller.feedforward"]),
    "wall of stages": Scene(f"robot=combined {_WALL}", ["controller.actuated_stages"]),
    "unfelt": Scene(
        _ARM, ["wrist_sensor", "joint_torque_sensor", "endpoint_sensor", "disturbance_observer.torque", "plant_error",
               "noise.velocity_bandwidth", "robot.path_size", "robot.joint_error_limit",
               "controller.null_space_frequency", "robot.payload.position"],
        [], ["wrist_sensor=doubled", "joint_torque_sensor=weak", *_SENSORS],
    ),
    "seen": Scene(
        f"{_ARM} endpoint_sensor.read_by=[macro] endpoint_sensor.noise=1e-4 mismatch.length=1.01 "
        "endpoint_sensor.velocity=low_pass", ["endpoint_sensor"], [],
        ["endpoint_sensor=offset", *_options("endpoint_sensor")],
    ),
    **{
        f"{kinds.group} {kind}": Scene(f"{run} {kinds.group}={kind}", [kinds.group])
        for kinds, run in _SENSED.items()
        for kind in kinds.names() if kind != kinds.default and not kinds.is_user_supplied(kind)
    },
    "notch": Scene(f"{_ARM} notch=torques", ["notch"]),
    "shaped": Scene(f"{_ARM} input_shaper=zv input_shaper.frequency=8", ["input_shaper"], [], ["input_shaper=zvd"]),
    "settled": Scene(f"{_LAW} controller=computed_torque robot.settling_band=1.0", ["robot.settling_band"]),
    "noisy as the robot": Scene(
        f"{_ARM} noise=thesis torque_limits=thesis", ["robot.joint_error_limit", "robot.torque_limit"]
    ),
    "held": Scene(f"{_LAW} controller=held_torques controller.torques=[2,-9,3]", ["controller"]),
    **{
        law: Scene(f"robot=xarm7 controller={law} duration=0.2 {more}", ["controller"])
        for law, more in {"three_joint": "", "xarm7_as_printed": "controller.inverse=right"}.items()
    },
    "from_file": Scene(
        f"robot=macro controller=computed_torque trajectory=from_file trajectory.file={_MOTION} duration=0.1",
        ["trajectory"],
    ),
    **{
        shape: Scene(f"robot=macro controller=computed_torque trajectory={shape} duration=0.1 {more}", ["trajectory"])
        for shape, more in _SHAPES.items()
    },
}  # fmt: skip
"""The table of runs; the run of a scene is made on each plant that accepts it."""

CHANGED: Mapping[str, Any] = {
    "robot.inertials": "legacy_wrong",
    "robot.settling_band": 1e-9,
    "robot.masses": {"link2": 3.3},
    "robot.armature": 0.3,
    "robot.period": 0.02,
    "plant.servo.period": 0.0005,
    "robot.start": [0.55, 0.02, 0.25],
    "robot.payload.schedule": [{"at": 0.02, "mass": 2.0}],
    "robot.rated_payload": 0.1,
    "robot.payload.position": [0.02, 0.03, 0.01],
    "plant.step": 0.0005,
    "plant.computation.delay": 1,
    "plant.computation.jitter": [0.5, 0.5],
    "plant.computation.miss": [0, 1],
    "plant.min_inertia": 1e-3,
    "torque_limits.max": 3.0,
    "torque_limits.no_load_speed": 0.2,
    "controller.period": 0.004,
    "environment.bandwidth": 20.0,
    "environment.link": "link2",
    "trajectory.start": [0.55, 0.02, 0.25],
    "controller.cutoff": None,
    "wrist_sensor.low_pass": 20.0,
    "joint_torque_sensor.noise": 0.3,
    "endpoint_sensor.period": 0.004,
    "endpoint_sensor.delay": 0.004,
    "disturbance_observer.bandwidth": 17.0,
    "input_shaper.damping_ratio": 0.3,
    "controller.null_space.max_speed": 1e-3,
    "controller.weights": [1.0, 2.0, 1.0, 1.0, 1.0, 1.0, 1.0],
    "wrist_sensor.range": [0.1, 0.1, 0.1, 0.01, 0.01, 0.01],
    "controller.max_tip_speed": 1e-3,
    "controller.sensor.low_pass": 20.0,
    "controller.reach": 0.01,
    "controller.limit_approach": 1e-3,
    "controller.null_space.posture": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7],
    "endpoint_sensor.read_by": [],
    "environment.duration": 0.02,
    "plant.flexible_joints.brake_time": {"macro": 0.02},
    "trajectory.start_configuration": [0.1, 0.2, 0.3],
    "trajectory.coefficients": [[[0.1, 0.0], [0.0, 0.05], [0.02, 0.01]]] * 3,
    "trajectory.origin": [0.5, 0.0, 0.2],
    "trajectory.time_shares": [0.2, 0.5, 0.8, 1.0],
    "mismatch.link": {"link2": {"mass": 1.4}},
}
"""Value of a key, where a rule for its type does not suffice."""

LEFT_OUT: Mapping[str, str] = {
    "robot.urdf": "another file is another robot",
    "robot.mjcf": "another file is another robot",
    "robot.name": "a label",
    "robot.tip": "a name of a frame in the file",
    "robot.no_joint_error": "0 for each stage, for noise=none",
    "robot.stages": "the keys of each arm; the scene arm changes them",
    "trajectory.columns": "the content of a file",
    "trajectory.file": "a file",
}
"""Keys that the walk does not change, with the reason."""

WITHOUT_PHYSICS = ("preset", "sweep", "limits", "caveats", "spec")
"""Groups that the walk leaves out: values that other groups take, and keys that change no run."""

_NEAR_SINGULAR = "acts near singular configurations only"
EXCEPTIONS: Mapping[str, str] = {
    "controller.singularity_damping": _NEAR_SINGULAR,
    "controller.damping": _NEAR_SINGULAR,
    "bouncing robot.tool.tip_radius": "the wall is as far from the ball as from the tip, unless the plant has the ball",
    "sliding_mode controller.boundary_layer": "cancels within the layer: the gain is proportional to it",
}
"""Changes without effect that are meant, as SCENE KEY, or KEY in every scene, with the reason."""
