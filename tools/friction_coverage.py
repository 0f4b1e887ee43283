"""Coverage of the 95 % intervals of identified friction: simulated recordings of 10 s at 250 Hz.

Friction, amplitudes, frequencies and phases are drawn at random. The fit was chosen on the Macro with seeds below
2,000; these are others, and two arms that it was not chosen on. In the last case the model lacks rotors of 0.3 to 2
kg m^2 at each joint, up to 20 times what the ur5e's has.
"""

import os
from concurrent.futures import ProcessPoolExecutor
from functools import cache, partial
from pathlib import Path

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from runner.assembly.validation import validate
from runner.config.compose.compose import compose
from runner.recordings.columns_map import Signal
from runner.recordings.compare import friction_of
from runner.recordings.recording import Recording
from runner.robots.model import RobotModel

_LOGS = {"macro": 2_000, "xarm7": 300, "ur5e": 300}
_FIRST_SEED = 100_000
_WANTED = (0.93, 0.97)
_PERIOD, _LASTS = 4e-3, 10.0  # s
_PARTS = 4  # of a row, over which a held torque is the mean
_NOISE = 5e-5, 0.3  # rad, N m
_STEPS = 1e-4, 0.05  # rad, N m
_CASES = {
    "ideal": (),
    "torque held over a row": ("held",),
    "noise": ("noise",),
    "quantised": ("steps",),
    "all together": ("held", "noise", "steps"),
    "all, unknown rotors": ("held", "noise", "steps", "rotors"),
}
FloatArray = NDArray[np.float64]


def main() -> bool:
    """Print the table; return whether each share lies in the wanted range."""
    met = True
    for arm, logs in _LOGS.items():
        print(f"{arm}, {logs} recordings each: viscous, Coulomb, median half-widths in N m s/rad and N m")
        for case, effects in _CASES.items():
            with ProcessPoolExecutor(os.cpu_count()) as pool:
                seeds = range(_FIRST_SEED, _FIRST_SEED + logs)
                found = np.vstack(list(pool.map(partial(_errors, arm, effects), seeds, chunksize=10)))
            shares = np.mean(np.abs(found[:, :2]) < found[:, 2:], axis=0)
            good = bool(np.all((shares >= _WANTED[0]) & (shares <= _WANTED[1])))
            met &= good
            halves = np.median(found[:, 2:], axis=0)
            print(
                f"  {case:22} {shares[0]:6.1%} {shares[1]:6.1%}  {halves[0]:.2g} {halves[1]:.2g}  of {len(found)} "
                f"joints: {'met' if good else 'MISSED'}",
                flush=True,
            )
    return met


@cache
def _model(arm: str) -> RobotModel:
    return validate(compose([f"robot={arm}"])).arm.model


def _errors(arm: str, effects: tuple[str, ...], seed: int) -> FloatArray:
    """Return errors and half-widths of viscous and Coulomb friction of each joint, shape (joints, 4)."""
    model, random = _model(arm), np.random.default_rng(seed)
    shape = (3, model.nq)
    swing, speeds, phases = (random.uniform(*ends, shape) for ends in ((0.15, 0.5), (1.0, 6.0), (0.0, 2.0 * np.pi)))
    viscous, coulomb, constant = (random.uniform(*ends, model.nq) for ends in ((0.3, 1.5), (0.3, 1.5), (-0.3, 0.3)))
    rotors = random.uniform(0.3, 2.0, model.nq) if "rotors" in effects else np.zeros(model.nq)
    pin_model, data = model.pin_model, model.pin_model.createData()

    def motion(t: FloatArray) -> list[FloatArray]:
        angles = t[:, None, None] * speeds + phases
        waves = (np.sin(angles), speeds * np.cos(angles), -(speeds**2) * np.sin(angles))
        return [np.sum(swing * wave, axis=1) for wave in waves]

    def torques(t: FloatArray) -> FloatArray:
        rows = motion(t)
        rigid = np.array([pin.rnea(pin_model, data, *row) for row in zip(*rows, strict=True)])
        return np.asarray(rigid + rotors * rows[2] + viscous * rows[1] + coulomb * np.sign(rows[1]) + constant)

    t = np.arange(0.0, _LASTS, _PERIOD)
    parts = (np.arange(_PARTS) + 0.5) / _PARTS if "held" in effects else np.zeros(1)
    signals = [motion(t)[0], np.mean([torques(t + part * _PERIOD) for part in parts], axis=0)]
    if "noise" in effects:
        signals = [
            values + size * random.normal(size=values.shape) for values, size in zip(signals, _NOISE, strict=True)
        ]
    if "steps" in effects:
        signals = [np.round(values / step) * step for values, step in zip(signals, _STEPS, strict=True)]
    recorded = {
        Signal(kind, name): values[:, joint]
        for kind, values in (("position", signals[0]), ("torque", signals[1]))
        for joint, name in enumerate(model.joint_names)
    }
    found, _ = friction_of(model, Recording(Path("simulated.csv"), t, recorded, {}, {}, "held" in effects, ()))
    assert found is not None
    places = [model.joint_names.index(each.joint) for each in found.joints]
    return np.array(
        [
            (each.viscous - viscous[at], each.coulomb - coulomb[at], each.viscous_half, each.coulomb_half)
            for at, each in zip(places, found.joints, strict=True)
        ]
    ).reshape(-1, 4)
