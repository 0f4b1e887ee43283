"""Made-up logs with a wrong column map: counts which are asked for, and which right ones are not.

Each log is of another motion of one of five arms whose masses, friction and rotors differ from the model. It holds a
torque, a tip or commanded positions. A fault is one joint inverted, two or three exchanged, a joint or all in another
unit, times in another unit, or a torque in per cent.
"""

from collections import Counter
from functools import cache
from pathlib import Path

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from runner.assembly.validation import validate
from runner.base.errors import RunnerError
from runner.base.tables import NumericTable
from runner.config.compose.compose import compose
from runner.doctor.log import LogExamination, judge
from runner.recordings.columns_map import ColumnsMap
from runner.robots.model import RobotModel

_LOGS = 500
_ARMS = ("ur5e", "panda", "iiwa14", "xarm7", "gen3")
FAULTS = ("none", "inverted", "exchanged", "rotated", "one in deg", "all in deg", "time in ms", "torque in %")
EVIDENCE = ("torque", "tip", "reference")
_PERIOD, _LASTS = 8e-3, 8.0  # s
_NOISE = {"joint": 2e-5, "torque": 0.1, "tip": 1e-4, "reference": 0.0}  # rad, N m, m
FloatArray = NDArray[np.float64]


def main() -> bool:
    """Print the table; return whether each fault that the log can tell is asked for, and no right log is."""
    counts: Counter[tuple[str, str]] = Counter()
    for seed in range(_LOGS):
        fault, answer = judge_log(seed)
        counts[fault, answer] += 1
        if answer == "MISSED":
            print(f"seed {seed}: {fault}")
    answers = sorted({answer for _, answer in counts})
    print(f"{'':14}{''.join(f'{answer:>24}' for answer in answers)}")
    for fault in FAULTS:
        print(f"{fault:14}{''.join(f'{counts[fault, answer]:24}' for answer in answers)}")
    return not any(answer == "MISSED" for _, answer in counts)


def judge_log(seed: int) -> tuple[str, str]:
    """Return the fault of a made-up log, and what became of it."""
    rng = np.random.default_rng(seed)
    model = _model(_ARMS[seed % len(_ARMS)])
    fault, evidence = FAULTS[seed // len(_ARMS) % len(FAULTS)], EVIDENCE[int(rng.integers(3))]
    evidence = "torque" if fault == "torque in %" else evidence
    signals, touched = _spoilt(_signals(model, rng), fault, model, rng)
    columns: dict[str, dict[str, str]] = {}
    for kind in ("joint", evidence):
        for place, name in enumerate("xyz" if kind == "tip" else model.joint_names):
            unit = {"torque": "N m", "tip": "m"}.get(kind, "rad")
            columns[f"{kind} {place}"] = {kind: name, "unit": unit}
    values = {"t": signals["t"][:, 0]} | {name: signals[name.split()[0]][:, int(name.split()[1])] for name in columns}
    said = ColumnsMap.model_validate({"time": {"column": "t", "unit": "s"}, "columns": columns})
    found = LogExamination(NumericTable(Path("made_up"), "", values), "", None, (), (), None, None)
    try:
        asked = judge(found, model, said)
    except RunnerError:
        return fault, "refused" if fault != "none" else "MISSED"
    if fault == "none":
        return fault, "right" if not asked.questions else "MISSED"
    if asked.questions:
        return fault, "asked"
    silent = [name for name in touched if f"joint '{name}': nothing in the log" in " ".join(map(str, asked.findings))]
    return fault, "said: not seen in it" if silent else "MISSED"


@cache
def _model(arm: str) -> RobotModel:
    return validate(compose([f"robot={arm}"])).arm.model


def _signals(model: RobotModel, rng: np.random.Generator) -> dict[str, FloatArray]:
    t = np.arange(0.0, _LASTS, _PERIOD)
    lower, upper = model.usual_range
    middle = 0.5 * (lower + upper) + 0.1 * (upper - lower) * rng.uniform(-1.0, 1.0, model.nq)
    swing, rates = np.minimum(0.25 * (upper - lower), rng.uniform(0.3, 0.6, model.nq)), rng.uniform(0.8, 2.5, model.nq)
    angle = np.outer(t, rates) + rng.uniform(0.0, 2.0 * np.pi, model.nq)
    q, dq, ddq = middle + swing * np.sin(angle), swing * rates * np.cos(angle), -swing * rates**2 * np.sin(angle)
    arm = model.pin_model.copy()
    for joint in range(1, arm.njoints):
        inertia = arm.inertias[joint]
        arm.inertias[joint] = pin.Inertia(inertia.mass * rng.uniform(0.7, 1.3), inertia.lever, inertia.inertia)
    data = arm.createData()
    torque = np.array([pin.rnea(arm, data, *row) for row in zip(q, dq, ddq, strict=True)])
    size = np.maximum(0.02 * np.minimum(model.effort_limits, 200.0), 0.2)
    torque += size * (rng.uniform(0.3, 1.0, model.nq) * np.sign(dq) + rng.uniform(0.3, 1.0, model.nq) * dq)
    torque += rng.uniform(0.0, 0.3, model.nq) * ddq
    signals = {"joint": q, "torque": torque, "tip": model.tip_positions(q), "reference": q + 0.01 * dq}
    noisy = {kind: values + _NOISE[kind] * rng.normal(size=values.shape) for kind, values in signals.items()}
    return {"t": t[:, None], **noisy}


def _spoilt(
    signals: dict[str, FloatArray], fault: str, model: RobotModel, rng: np.random.Generator
) -> tuple[dict[str, FloatArray], list[str]]:
    """Return the signals with a fault, and the joints that it touches."""
    places = rng.permutation(model.nq)[: {"exchanged": 2, "rotated": 3}.get(fault, 1)]
    q = signals["joint"].copy()
    if fault == "inverted":
        q[:, places] *= -1.0
    elif fault in ("exchanged", "rotated"):
        q[:, places] = q[:, np.roll(places, 1)]
    elif fault == "one in deg":
        q[:, places] *= 180.0 / np.pi
    elif fault == "all in deg":
        q *= 180.0 / np.pi
    elif fault == "time in ms":
        return {**signals, "t": 1e3 * signals["t"]}, []
    elif fault == "torque in %":
        place = int(np.argmax(np.abs(signals["torque"]).mean(axis=0)))
        torque = signals["torque"].copy()
        torque[:, place] *= (
            100.0 / (2.0 * model.effort_limits[place]) if model.effort_limits[place] > 150 else 100.0 / 9.0
        )
        return {**signals, "torque": torque}, [model.joint_names[place]]
    return {**signals, "joint": q}, [model.joint_names[place] for place in places]
