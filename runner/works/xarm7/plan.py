"""Which runs the xArm7 report needs, as runs.yaml has them, and the levels that its chapters go through."""

from runner.reporting.job import Jobs
from runner.works.grids import grids_of

_GRIDS = grids_of(__file__)
STEPS = _GRIDS.levels("servo", "plant.step", float)  # s, of PyBullet
TASKS = _GRIDS.levels("printed", "controller.task", str)
# The report's errors, each of which can be put right: which of them a case keeps.
ERRORS = {
    case: tuple(own.removeprefix("controller.").removesuffix("=printed") for own in overrides if "=printed" in own)
    for case, overrides in _GRIDS.labels("printed", "case").items()
}
GAIN = _GRIDS.value("printed/fed back", "gain")  # 1/s, of the tip's error, where it is fed back
RULES = _GRIDS.levels("null_space", "rule", str)
SPEEDS = _GRIDS.levels("null_space", "speed", float)  # rad/s, of the null-space motion
FASTEST_RATE = _GRIDS.value("null_space/fastest", "rate")  # Hz
NULL_SPACE_TASKS = _GRIDS.levels("cycles", "task", str)
PATHS = _GRIDS.levels("cycles", "path", str)
CYCLES, CYCLE = int(_GRIDS.value("cycles", "cycles")), _GRIDS.value("cycles", "cycle")  # number, and s
CLIMB_CYCLES, CLIMB_CYCLE = int(_GRIDS.value("climb", "cycles")), _GRIDS.value("climb", "cycle")
RATES = _GRIDS.levels("rates", "rate", int)  # Hz
PLANTS = _GRIDS.levels("rates", "plant", str)
STIFFNESSES = _GRIDS.levels("stiffness", "stiffness", float)  # N m/rad
GRAVITY_COMPENSATION = _GRIDS.levels("stiffness", "compensation", str)
FEEDBACKS = _GRIDS.levels("stiffness", "feedback", str)
XS = _GRIDS.levels("payload", "x", float)  # m, as printed, and of the round posture
ASKED_PAYLOADS = _GRIDS.levels("payload/asked", "robot.payload.mass", float)  # kg
PAYLOADS = _GRIDS.levels("payload", "robot.payload.mass", float)  # kg
LAWS = _GRIDS.levels("torque", "controller", str)
TORQUE_PAYLOADS = _GRIDS.levels("torque", "robot.payload.mass", float)  # kg


def plan() -> Jobs:
    """Return every run by name."""
    return _GRIDS.jobs()
