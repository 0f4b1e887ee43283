"""Which runs the Meca500 report needs: those of runs.yaml, and those whose overrides are computed."""

from typing import NamedTuple

import numpy as np

from runner.controllers.admittance_filter import Admittance
from runner.controllers.admittance_stability import stiffest_wall
from runner.reporting.job import Job, Jobs
from runner.robots import RobotModel, find_urdf, read_urdf
from runner.works.grids import grids_of

GRIDS = grids_of(__file__)
REPORTED = GRIDS.value("step", "reported")  # s, between two reports of the real controller
STEP_CASES = GRIDS.levels("step", "case", str)
SINE_CASES = GRIDS.levels("sine", "case", str)
FREQUENCIES = GRIDS.levels("sine", "environment.frequency", float)  # Hz
TIP_CASES = GRIDS.levels("tip", "case", str)
PLANTS = GRIDS.levels("wall", "plant", str)
WALLS = tuple(float(stiffness) for stiffness in GRIDS.levels("wall", "stiffness", str))  # N/m
LIMITS = GRIDS.levels("limit", "limit", str)
SWINGS = GRIDS.levels("swing", "lap", float)  # s, around the circle
INERTIALS = GRIDS.levels("inertials", "robot.inertials", str)
STEPS = GRIDS.levels("plants/steps", "plant.step", float)  # s, of PyBullet
ORIENTATIONS = 100
# The law that is held against walls: M, B and K along every axis, in kg, N s/m and N/m.
MASS, DAMPING, STIFFNESS = 2.0, 80.0, 800.0
MAP_PERIODS = (0.001, 0.005, 0.01, REPORTED)  # s
MAP_SHARES = (0.5, 0.8, 0.9, 1.1, 1.25, 2.0)  # of the bound


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
    return {**GRIDS.jobs(), **_map(), **_rests()}


def _map() -> Jobs:
    jobs = {}
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


def _rests() -> Jobs:
    jobs = {}
    for number, home in enumerate(_homes(ORIENTATIONS)):
        posture = f"robot.home={home.round(6).tolist()}".replace(" ", "")
        jobs[f"rest/{number}"] = _job("weighing", (posture, "wrist_sensor=mini40", f"seed={number}"))
    return jobs


def _job(experiment: str, overrides: tuple[str, ...]) -> Job:
    return Job((f"experiment=meca500/{experiment}", *overrides))


def _homes(count: int) -> np.ndarray:
    """Return postures inside the joint limits, turned by half a turn at most, shape (count, 6), in rad."""
    lower, upper = np.clip(
        RobotModel(read_urdf(find_urdf("meca500.urdf"), {}), "flange").position_limits, -np.pi, np.pi
    )
    homes: np.ndarray = np.random.default_rng(0).uniform(lower, upper, (count, 6))
    return homes
