"""Computed runs and calibrations of the Meca500 study, in addition to runs.yaml."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from runner.controllers.force.admittance_filter import Admittance
from runner.controllers.stability import stiffest_wall
from runner.robots import RobotModel, find_urdf, read_urdf
from runner.study.grid import Overrides
from runner.study.grids import FILE, Grids

GRIDS = Grids(Path(__file__).with_name(FILE))
REPORTED = GRIDS.value("step", "reported")  # s, between two reports of the real controller
SINE_CASES = GRIDS.levels("sine", "case", str)
FREQUENCIES = GRIDS.levels("sine", "environment.frequency", float)  # Hz
ORIENTATIONS = 100
# The law that is held against walls: M, B and K along every axis and about it, in kg, N s/m and N/m, and likewise.
_LAW = {"mass": (2.0, 0.02), "damping": (80.0, 0.8), "stiffness": (800.0, 8.0)}
_PERIODS = (0.001, 0.005, 0.01, REPORTED)  # s
_SHARES = (0.5, 0.8, 0.9, 1.1, 1.25, 2.0)  # of the bound
# Period of the controller in s, period of the servos and step of the plant in s, stiffness of the servos in N m/rad,
# and stiffness about which those of the walls are spread in N/m: the predicted bound to three digits.
_SERVOS = (
    (0.005, 0.001, 1.5e5, 3.49e4),
    (0.01, 0.001, 1.5e4, 2.01e4),
    (REPORTED, 0.000835, 1.5e4, 1.06e4),
    (REPORTED, 0.000835, 1.5e5, 9.52e3),
    (REPORTED, 0.000167, 1.5e3, 3.70e4),
    (REPORTED, 0.000167, 1.5e5, 8.90e3),
)


def law() -> Admittance:
    """Return the law of the stability map."""
    return Admittance(*(np.repeat(values, 3) for values in _LAW.values()))


def computed_runs() -> dict[str, Overrides]:
    """Return the runs whose overrides are computed, by name."""
    return {**_map(), **_rests()}


def calibrations(given: Mapping[str, Overrides]) -> dict[str, Overrides]:
    """Return the overrides of every calibration by name; each draws from a seed of its own.

    With one seed for all they would be the same draws rescaled, and what is counted over them one test. The level of a
    grid that is the base case is the base case itself, which is carried out once.
    """
    jobs: dict[str, Overrides] = {}
    seeds = 0
    for name, overrides in given.items():
        grid, _, level = name.rpartition("/")
        if level != "base" and GRIDS.grid(grid).values.get("base") == float(level):
            jobs[name] = jobs[f"{grid.partition('/')[0]}/base"]
        else:
            jobs[name] = (*overrides, f"seed={seeds}")
            seeds += 1
    return jobs


def _map() -> dict[str, Overrides]:
    values = (f"controller.{key}={3 * [along] + 3 * [about]}".replace(" ", "") for key, (along, about) in _LAW.items())
    base = ("experiment=meca500/wall", *values, "environment.distance=0", "environment.damping=0",
            "controller.check_stability=false", "duration=1.2")  # fmt: skip
    jobs = {}
    for period in _PERIODS:
        bound = stiffest_wall(law(), period, 0, 0.0, 0)
        for share in _SHARES:
            own = (f"controller.period={period}", f"environment.stiffness={share * bound:.5g}")
            jobs[f"map/kinematic/{period}/{share}"] = (*base, *own)
    for period, tick, spring, wall in _SERVOS:
        servo = ("plant=default", f"plant.servo.period={tick}", f"plant.step={tick}",
                 f"plant.servo.stiffness={spring:g}", "trajectory.goal=[0.185,0.01,0.06]")  # fmt: skip
        case = f"{1e3 * period:g} ms, servos {1e3 * tick:g} ms, {spring:g}"
        for share in _SHARES:
            own = (f"controller.period={period}", f"environment.stiffness={share * wall:.5g}")
            jobs[f"map/servos/{case}/{share}"] = (*base, *servo, *own)
    return jobs


def _rests() -> dict[str, Overrides]:
    """Return the tool weighed at rest in postures inside the joint limits, turned by half a turn at most."""
    model = RobotModel(read_urdf(find_urdf("meca500.urdf"), {}), "flange")
    low, high = np.clip(model.position_limits, -np.pi, np.pi)
    homes = np.random.default_rng(0).uniform(low, high, (ORIENTATIONS, 6))
    jobs: dict[str, Overrides] = {}
    for number, home in enumerate(homes):
        posture = f"robot.home={home.round(6).tolist()}".replace(" ", "")
        jobs[f"rest/{number}"] = ("experiment=meca500/weighing", posture, "wrist_sensor=mini40", f"seed={number}")
    return jobs
