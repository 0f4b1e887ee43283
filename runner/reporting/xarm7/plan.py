"""Which runs the xArm7 report needs: a name for each, and the overrides that make it."""

from runner.reporting.job import PRESETS, Job, Jobs, longest_first
from runner.reporting.xarm7.studies_plan import studies_jobs

EXPERIMENTS = ("three_joints", "round_posture", "seven_joints", "seven_joints_pose", "as_printed")
STEPS = (1e-3, 5e-4, 2.5e-4)  # s, of PyBullet
_TICKS = 2000  # of 20 s at 100 Hz
_SERVO_TICKS = 3000  # of 5 s, in ticks of the kinematic plant that take as long
_HALF = "duration=5"  # s, half a period: from A to B


def plan() -> Jobs:
    """Return every run by name, the longest first."""
    jobs = {
        f"{name}/{preset}": Job((f"experiment=xarm7/{name}", f"preset={preset}"), _TICKS)
        for name in EXPERIMENTS
        for preset in PRESETS
    }
    for preset in PRESETS:
        servo = ("experiment=xarm7/three_joints", _HALF, f"preset={preset}")
        jobs[f"servo/{preset}/rk4"] = Job((*servo, "plant=rk4"), _SERVO_TICKS)
        for step in STEPS:
            overrides = (*servo, "plant=bullet", f"plant.step={step}")
            jobs[f"servo/{preset}/{step}"] = Job(overrides, _SERVO_TICKS)
    return longest_first(jobs | studies_jobs())
