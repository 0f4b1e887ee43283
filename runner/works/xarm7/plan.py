"""Which runs the xArm7 report needs: a name for each, and the overrides that make it."""

from runner.reporting.job import PRESETS, Job, Jobs
from runner.works.xarm7.studies_plan import studies_jobs

EXPERIMENTS = ("three_joints", "round_posture", "seven_joints", "seven_joints_pose", "as_printed")
STEPS = (1e-3, 5e-4, 2.5e-4)  # s, of PyBullet
_HALF = "duration=5"  # s, half a period: from A to B


def plan() -> Jobs:
    """Return every run by name."""
    jobs = {
        f"{name}/{preset}": Job((f"experiment=xarm7/{name}", f"preset={preset}"))
        for name in EXPERIMENTS
        for preset in PRESETS
    }
    for preset in PRESETS:
        servo = ("experiment=xarm7/three_joints", _HALF, f"preset={preset}")
        jobs[f"servo/{preset}/rk4"] = Job((*servo, "plant=rk4"))
        for step in STEPS:
            overrides = (*servo, "plant=bullet", f"plant.step={step}")
            jobs[f"servo/{preset}/{step}"] = Job(overrides)
    return jobs | studies_jobs()
