"""Makes the reference bands that ship with the package, from many seeds: `python -m tools.reference_bands [NAME...]`.

Each band holds the smallest and the largest of the medians that SEEDS give, widened on both sides by half the
interquartile range of single repetitions (some three standard errors of a median of 40) and by MARGIN of the
value, for other machines' rounding. Read the files before you commit them: a band is a statement.
"""

import math
import multiprocessing
import sys
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import yaml
from tqdm import tqdm

from runner.base.engines import quiet_environment
from runner.config.compose.files import group_options
from runner.store import Run, open_run
from runner.store.baselines import baseline_path

SEEDS = range(5)
MARGIN = 0.02
PRESETS = ("full_equations", "as_reported")

_POSITIONING = ("settling_time", "steady_state_error", "peak_torque", "saturation_fraction")
_WHOLE_MOVE = ("overshoot", "cross_track_error", "energy", "control_effort")
_TRACKING = (*_POSITIONING, *_WHOLE_MOVE, "max_axis_error", "rms_tracking_error")
_LINE = ("max_axis_error", "rms_tracking_error", "peak_joint_speed", "peak_torque")
_FOLLOWED = ("max_axis_error", "rms_tracking_error", "peak_torque", "torque_chatter")
METRICS = {
    # The Macro's goal move depends on the branch that it takes: a band of its whole-move metrics would mean little.
    "thesis/figure_3_5": _POSITIONING,
    "thesis/figure_3_9": _TRACKING,
    "thesis/figure_3_10": _TRACKING,
    "thesis/figure_4_2": (*_POSITIONING, *_WHOLE_MOVE),
    "thesis/figure_4_4": _TRACKING,
    "thesis/figure_5_8": ("settling_time", "steady_state_error"),
    "thesis/figure_5_10": ("settling_time", "steady_state_error"),
    "thesis/figure_5_12": ("max_axis_error", "rms_tracking_error", "steady_state_error"),
    "thesis/figure_5_13": ("max_axis_error", "rms_tracking_error"),
    "thesis/macro_alone": ("macro_max_axis_error", "macro_steady_state_error"),
    "xarm7/three_joints": _LINE,
    "xarm7/round_posture": _LINE,
    "xarm7/seven_joints": (*_LINE, "cross_track_error"),
    "xarm7/seven_joints_pose": (*_LINE, "cross_track_error"),
    "benchmark/macro": _FOLLOWED,
    "benchmark/planar": _FOLLOWED,
    "benchmark/xarm7": _FOLLOWED,
    "meca500/push": ("peak_force", "peak_joint_speed"),
    "meca500/wall": ("peak_force", "steady_force", "peak_joint_speed"),
    "meca500/hand": ("peak_force", "peak_joint_speed"),
    "meca500/circle": ("max_axis_error", "rms_tracking_error", "peak_joint_speed", "peak_torque"),
}
# Wider than the seeds show, in the metric's unit: plant, velocity estimate and rounding change the branch of the
# saturated transient, and move its median by 0.3 s of the run's 4 s. The Mini is the Macro scaled, times by a tenth.
EXTRA = {
    ("thesis/figure_3_5", "settling_time"): 0.3,
    ("thesis/figure_3_5", "saturation_fraction"): 0.075,
    ("thesis/figure_5_8", "settling_time"): 0.3,
    ("thesis/figure_5_10", "settling_time"): 0.3,
    ("thesis/figure_4_2", "settling_time"): 0.03,
    ("thesis/figure_4_2", "saturation_fraction"): 0.0075,
}

_BASE_AXIS = "joint 1 is at its limit where the path passes the base axis, and lags whatever the controller"
_NOISE = "what the encoders' noise leaves, with gravity compensated and feedforward"
_SAG = "the sag without the gravity term, J M^-1 G / omega_n^2, and the encoders' noise"
_LAG = "the lag without feedforward, up to (2 xi / omega_n) 1.875 D / t_f, with sag and the encoders' noise"
_SUM = "a sum over the whole move, in which single noise draws hardly show"


_BASE_ENCODERS = "the Macro's encoders, seen through the Mini's base"
_STAGED = {
    ("figure_5_8", "full_equations", "steady_state_error"): _BASE_ENCODERS,
    ("figure_5_8", "as_reported", "steady_state_error"): _BASE_ENCODERS,
    ("figure_5_10", "full_equations", "steady_state_error"): f"{_BASE_ENCODERS}, and more once the Mini is stretched",
    ("figure_5_10", "as_reported", "steady_state_error"): "the Macro's sag once the Mini is stretched",
    ("figure_5_12", "full_equations", "max_axis_error"): _BASE_ENCODERS,
    ("figure_5_12", "full_equations", "rms_tracking_error"): _BASE_ENCODERS,
    ("figure_5_12", "full_equations", "steady_state_error"): _BASE_ENCODERS,
    ("figure_5_12", "as_reported", "max_axis_error"): "the Mini's lag behind a series of goals",
    ("figure_5_12", "as_reported", "rms_tracking_error"): "the Mini's lag behind a series of goals",
    ("figure_5_12", "as_reported", "steady_state_error"): _BASE_ENCODERS,
    ("figure_5_13", "full_equations", "max_axis_error"): "what is left where the Mini is stretched, late in the motion",
    ("figure_5_13", "full_equations", "rms_tracking_error"): _BASE_ENCODERS,
    ("figure_5_13", "as_reported", "max_axis_error"): "the Macro's lag, because the Mini is stretched",
    ("figure_5_13", "as_reported", "rms_tracking_error"): "the Macro's lag, because the Mini is stretched",
    ("macro_alone", "full_equations", "macro_max_axis_error"): _BASE_AXIS,
    ("macro_alone", "as_reported", "macro_max_axis_error"): _BASE_AXIS,
    (
        "macro_alone",
        "full_equations",
        "macro_steady_state_error",
    ): "the Mini's weight, which the Macro does not know, and noise",
    ("macro_alone", "as_reported", "macro_steady_state_error"): _SAG,
}
# Reasons of tracking errors on the xArm7's line: by three joints, which feed nothing back, and by seven.
_LINE_ERRORS = {
    ("three", "full_equations"): "the motion's third derivative within a period; the first two are known",
    ("three", "as_reported"): "the way that the tip goes within a period: so late are joints without feedforward",
    ("seven", "full_equations"): "what the integration over a period leaves",
    ("seven", "as_reported"): "the lag behind the error feedback, the tip's speed over its gain",
}


def explain_line(experiment: str, preset: str, metric: str) -> str:
    """Return why a metric of the xArm7's line is where it is."""
    reasons = {
        "peak_joint_speed": "only the line, its period and the inverse kinematics",
        "peak_torque": "the arm's weight on joint 2, by inverse dynamics",
        "cross_track_error": _LINE_ERRORS["seven", "full_equations"],
    }
    joints = "seven" if experiment.startswith("xarm7/seven") else "three"
    return reasons.get(metric, _LINE_ERRORS[joints, preset])


# Reasons of what a Meca500 that yields feels and does.
_TOUCH = {
    ("push", "peak_force"): "the push itself",
    ("wall", "peak_force"): "the law's mass and damping arrive at the wall with the speed of the approach",
    ("wall", "steady_force"): "the springs of law and wall in series",
    ("hand", "peak_force"): "damping at the hand's peak speed, and the law's mass",
    ("circle", "max_axis_error"): "the deflection of the law and its servos under the push",
    ("circle", "rms_tracking_error"): "the deflection of the law and its servos under the push",
    ("circle", "peak_torque"): "the arm's weight and inertia on servos",
}


def explain_touch(experiment: str, metric: str) -> str:
    """Return why a metric of the Meca500's admittance control is where it is."""
    return _TOUCH.get((experiment.rpartition("/")[2], metric), "the law's answer, through the arm's Jacobian")


# Reasons of what computed torque does with masses, friction and noise at once.
_WRONG = {
    "max_axis_error": "the unknown friction and wrong masses, against the stiffness of the loop",
    "rms_tracking_error": "the unknown friction and wrong masses, against the stiffness of the loop",
    "peak_torque": "weight, motion, and the encoders' noise through the velocity gain",
    "torque_chatter": "the encoders' noise through the velocity gain",
}


def explain(experiment: str, preset: str, metric: str, zero: bool) -> str:
    """Return why a metric is where it is."""
    if experiment.startswith("xarm7/"):
        return explain_line(experiment, preset, metric)
    if experiment.startswith("meca500/"):
        return explain_touch(experiment, metric)
    if experiment.startswith("benchmark/"):
        return _WRONG[metric]
    full, limited = preset == "full_equations", experiment == "thesis/figure_3_9"
    if zero:
        return "no error beyond the settling band" if metric == "settling_time" else "no joint at a limit"
    staged = _STAGED.get((experiment.rpartition("/")[2], preset, metric))
    if staged is not None:
        return staged
    reasons = {
        "settling_time": "back in the settling band " + ("after the base axis" if full else "as the lag fades"),
        "steady_state_error": _NOISE if full else _SAG,
        "peak_torque": "the limit, met near the base axis" if limited else "joint 1 near the base axis, and noise",
        "saturation_fraction": "joint 1 at its limit near the base axis",
        "overshoot": "the part of the error at rest that lies along the path",
        "cross_track_error": _BASE_AXIS if limited else _NOISE if full else _SAG,
        "energy": _SUM,
        "control_effort": _SUM,
        "max_axis_error": _BASE_AXIS if limited else _NOISE if full else _LAG,
        "rms_tracking_error": _LAG if not full else _BASE_AXIS if limited else _NOISE,
    }
    if experiment == "thesis/figure_4_4":
        reasons["peak_torque"] = "gravity on joint 2, 0.196 N m at home, and the answer to noise, lag and sag"
    if (experiment, "settling_time") in EXTRA:
        width = (
            f"known to {EXTRA[experiment, 'settling_time']:g} s of the run's 4 s, because it may take another branch"
        )
        reasons |= {
            "settling_time": f"a saturated transient, {width}",
            "saturation_fraction": f"a saturated transient, {width}",
            "peak_torque": "the limit, met from the first tick on",
            "overshoot": "a saturated transient",
            "cross_track_error": "a saturated transient",
        }
    return reasons[metric]


def run_seed(experiment: str, preset: str, seed: int) -> Path:
    """Run one experiment with one seed; in a worker process."""
    quiet_environment()
    import runner

    return runner.run(f"experiment={experiment}", f"preset={preset}", f"seed={seed}").folder


def make_band(runs: list[Run], experiment: str, preset: str, metric: str) -> dict[str, float | str]:
    """Return the band of a metric from the runs of all seeds."""
    medians = [run.metrics[metric].median for run in runs]
    values = np.concatenate([run.values(metric) for run in runs])
    low, high = min(medians), max(medians)
    quartiles = np.nanpercentile(values, [25, 75])
    extra = EXTRA.get((experiment, metric), 0.5 * float(np.diff(quartiles)[0]) + MARGIN * high)
    unit = runs[0].metrics[metric].unit
    spread = f"{low:.4g}" if low == high else f"{low:.4g} to {high:.4g}"
    seeds = f"{len(medians)} seeds gave {spread}" + ("" if unit == "1" else f" {unit}")
    return {
        "min": max(0.0, _round(low - extra, math.floor)),
        "max": _round(high + extra, math.ceil),
        "reason": f"{explain(experiment, preset, metric, high == 0.0)}; {seeds}",
    }


def _round(value: float, direction: Callable[[float], int]) -> float:
    if value == 0.0:
        return 0.0
    digits = 2 - math.floor(math.log10(abs(value)))
    return round(direction(value * 10.0**digits) / 10.0**digits, digits)


def main() -> None:
    """Run all seeds of the experiments named, or of all, in both presets on two processes, and write the files."""
    chosen = {name: metrics for name, metrics in METRICS.items() if name in (sys.argv[1:] or METRICS)}
    jobs = [(experiment, preset, seed) for experiment in chosen for preset in PRESETS for seed in SEEDS]
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as pool:
        folders = list(tqdm(pool.map(run_seed, *zip(*jobs, strict=True)), total=len(jobs), unit="run"))
    stored = dict(zip(jobs, folders, strict=True))
    for experiment, metrics in chosen.items():
        for preset in PRESETS:
            runs = [open_run(stored[experiment, preset, seed]) for seed in SEEDS]
            bands = {metric: make_band(runs, experiment, preset, metric) for metric in metrics}
            path = baseline_path(f"{experiment}.{preset}")
            path.parent.mkdir(parents=True, exist_ok=True)
            head = (
                f"# {group_options('experiment')[experiment]}, preset {preset}\n# Made by tools/reference_bands.py.\n"
            )
            body = yaml.safe_dump({"schema": 1, "metrics": bands}, sort_keys=False, width=116)
            path.write_text(head + body)
            print(path)


if __name__ == "__main__":
    main()
