"""Which runs the Meca500 report needs: a name for each, and the overrides that make it."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from runner.controllers.admittance_filter import AXES, Admittance
from runner.controllers.admittance_stability import stiffest_wall
from runner.reporting.job import Job, Jobs
from runner.robots import RobotModel, find_urdf, read_urdf

REPORTED = 0.0167  # s, between two reports of the real controller
_SERVO = ("plant=bullet", "plant.step=0.001")
_SLOW = (f"controller.period={REPORTED}",)
# A servo period that the controller's is a multiple of.
_SLOW_SERVO = (*_SLOW, "plant=bullet", "plant.servo.period=0.000835", "plant.step=0.000835")
FORCE, MOMENT = 2.0, 0.05  # N and N m, of a push
STEP_CASES: Mapping[str, tuple[str, ...]] = {
    "kinematic, 1 ms": (),
    "kinematic, 16.7 ms": (*_SLOW, f"environment.begin={3 * REPORTED}"),
    "kinematic, 16.7 ms, felt late": (*_SLOW, f"environment.begin={3 * REPORTED + 1e-4}"),
    "servo, 1 ms": _SERVO,
    "servo, 16.7 ms": (*_SLOW_SERVO, f"environment.begin={3 * REPORTED}"),
}
FREQUENCIES = (0.5, 1.0, 2.0, 4.0, 8.0, 12.0, 16.0, 24.0)  # Hz
SINE_CASES: Mapping[str, tuple[str, ...]] = {
    "kinematic, 1 ms": (),
    "kinematic, 16.7 ms": _SLOW,
    "servo, 1 ms": _SERVO,
}
TIP_CASES: Mapping[str, tuple[str, ...]] = {
    "at the tip": (),
    "at the flange": ("controller.at=flange",),
    "at the tip, joint servos": _SERVO,
    "at the tip, Mini40": ("wrist_sensor=mini40",),
}
WALLS = {1e3: 20.0, 1e4: 20.0, 1e5: 200.0}  # N/m: N s/m
PLANTS: Mapping[str, tuple[str, ...]] = {"kinematic": (), "bullet": _SERVO}
# The law that is held against walls: M, B and K along every axis, in kg, N s/m and N/m.
MASS, DAMPING, STIFFNESS = 2.0, 80.0, 800.0
MAP_PERIODS = (0.001, 0.005, 0.01, REPORTED)  # s
MAP_SHARES = (0.5, 0.8, 0.9, 1.1, 1.25, 2.0)  # of the bound
LIMITS = ("speed_limit", "joint_limit", "out_of_reach")
ORIENTATIONS = 100
SWINGS = (4.0, 2.0, 1.0, 0.5)  # s, around the circle
STEPS = (1e-3, 5e-4, 2.5e-4)  # s, of PyBullet
INERTIALS = ("cad_closed", "uniform_density")


class ServoCase(NamedTuple):
    """Joint servos that press on walls.

    Attributes:
        period: Of the controller, in s.
        tick: Period of the servos and step of the plant, in s.
        spring: Stiffness of the servos, in N m/rad.
        wall: Stiffness about which those of the walls are spread, in N/m: the predicted bound to three digits.
    """

    period: float
    tick: float
    spring: float
    wall: float

    def job_name(self, share: float) -> str:
        """Return the name of the run against a share of the wall."""
        return f"map/bullet/{self.period}/{self.tick}/{self.spring:g}/{share}"


SERVO_CASES = (
    ServoCase(0.005, 0.001, 1.5e5, 3.49e4),
    ServoCase(0.01, 0.001, 1.5e4, 2.01e4),
    ServoCase(REPORTED, 0.000835, 1.5e4, 1.06e4),
    ServoCase(REPORTED, 0.000835, 1.5e5, 9.52e3),
    ServoCase(REPORTED, 0.000167, 1.5e3, 3.70e4),
    ServoCase(REPORTED, 0.000167, 1.5e5, 8.90e3),
)


def law() -> Admittance:
    """Return the law of the stability map."""
    mass, damping, stiffness = (np.full(6, value) for value in (MASS, DAMPING, STIFFNESS))
    return Admittance(mass, damping, stiffness)


def plan() -> Jobs:
    """Return every run by name."""
    return {**_free_space(), **_contact(), **_guiding(), **_arm()}


def _job(experiment: str, overrides: tuple[str, ...]) -> Job:
    return Job((f"experiment=meca500/{experiment}", *overrides))


def _free_space() -> Jobs:
    jobs = {}
    for case, overrides in STEP_CASES.items():
        for index, axis in enumerate(AXES):
            load = [0.0] * 6
            load[index] = FORCE if index < 3 else MOMENT
            wrench = (f"environment.force={load[:3]}", f"environment.moment={load[3:]}")
            jobs[f"step/{case}/{axis}"] = _job("push", (*overrides, *wrench))
    for case, overrides in SINE_CASES.items():
        for frequency in FREQUENCIES:
            own = (*overrides, f"environment.frequency={frequency}")
            jobs[f"sine/{case}/{frequency}"] = _job("sine", own)
    for case, overrides in TIP_CASES.items():
        jobs[f"tip/{case}"] = _job("push", (*overrides, "environment.force=[3,-2,4]"))
    return jobs


def _contact() -> Jobs:
    jobs = {}
    for plant, overrides in PLANTS.items():
        for stiffness, damping in WALLS.items():
            wall = (f"environment.stiffness={stiffness:g}", f"environment.damping={damping:g}")
            jobs[f"wall/{plant}/{stiffness:g}"] = _job("wall", (*overrides, *wall))
    values = (f"controller.{key}={3 * [value] + 3 * [turning]}".replace(" ", "") for key, value, turning in
              (("mass", MASS, 0.02), ("damping", DAMPING, 0.8), ("stiffness", STIFFNESS, 8.0)))  # fmt: skip
    base = (*values, "environment.distance=0", "environment.damping=0", "controller.check_stability=false",
            "duration=1.2")  # fmt: skip
    for period in MAP_PERIODS:
        bound = stiffest_wall(law(), period, 0, 0.0, 0)
        for share in MAP_SHARES:
            own = (f"controller.period={period}", f"environment.stiffness={share * bound:.5g}")
            jobs[f"map/kinematic/{period}/{share}"] = _job("wall", (*base, *own))
    for case in SERVO_CASES:
        servo = ("plant=bullet", f"plant.servo.period={case.tick}", f"plant.step={case.tick}",
                 f"plant.servo.stiffness={case.spring:g}", "trajectory.goal=[0.185,0.01,0.06]")  # fmt: skip
        for share in MAP_SHARES:
            own = (f"controller.period={case.period}", f"environment.stiffness={share * case.wall:.5g}")
            jobs[case.job_name(share)] = _job("wall", (*base, *servo, *own))
    return jobs


def _guiding() -> Jobs:
    jobs = {
        "hand/ideal": _job("hand", ()),
        "hand/lab": _job("hand", (*_SERVO, "wrist_sensor=mini40")),
    }
    return jobs | {f"limit/{name}": _job(name, ()) for name in LIMITS}


def _arm() -> Jobs:
    jobs = {}
    for number, home in enumerate(_homes(ORIENTATIONS)):
        posture = f"robot.home={home.round(6).tolist()}".replace(" ", "")
        jobs[f"rest/{number}"] = _job("weighing", (posture, "wrist_sensor=mini40", f"seed={number}"))
    for duration in SWINGS:
        own = (f"trajectory.duration={duration:g}", f"duration={duration:g}")
        jobs[f"swing/{duration}"] = _job("tool_in_motion", own)
    fine = (f"trajectory.duration={SWINGS[-1]:g}", f"duration={SWINGS[-1]:g}", "controller.period=0.0005")
    jobs["swing/fine"] = _job("tool_in_motion", (*fine, "plant.step=0.0005"))
    jobs["noise"] = _job("push", ("wrist_sensor=mini40", "environment.force=[0,0,0]", "duration=3"))
    for inertials in INERTIALS:
        jobs[f"inertials/{inertials}"] = _job("circle", (f"robot.inertials={inertials}", "plant.step=0.001"))
    for name, overrides in (("kinematic", ("plant=kinematic",)), ("rk4", ("plant=rk4",))):
        jobs[f"plants/{name}"] = _job("circle", overrides)
    for step in STEPS:
        jobs[f"plants/{step}"] = _job("circle", (f"plant.step={step}",))
    return jobs


def _homes(count: int) -> np.ndarray:
    """Return postures inside the joint limits, turned by half a turn at most, shape (count, 6), in rad."""
    lower, upper = np.clip(
        RobotModel(read_urdf(find_urdf("meca500.urdf"), {}), "flange").position_limits, -np.pi, np.pi
    )
    homes: np.ndarray = np.random.default_rng(0).uniform(lower, upper, (count, 6))
    return homes
