"""Coverage of the intervals of `runner identify` in 500 drawn worlds: arm, friction, noise, delay and excitation.

In a third of the worlds a wrong kind of friction is forced, and three logs are given. The torques of each world are
those of the equations of motion with other masses than the file's, so the truth is known. WORLDS sets their number.
After them 100 worlds have currents with wrong torque constants, and two logs, the second one with a known payload.
"""

import os
import resource
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from runner.assembly.validation import validate
from runner.config.compose.compose import compose
from runner.identification.checks import find_flags, second_method
from runner.identification.fit import Fit, fit_logs
from runner.identification.friction_kinds import TERMS, FrictionKind
from runner.identification.log_rows import LogRows, log_rows, payload_torques
from runner.identification.parameters import ParameterSum, base_sums
from runner.recordings.columns_map import FixedPayload
from runner.recordings.equations import EvenRows, motion_of
from runner.recordings.smoothing import cutoff
from runner.robots.model import RobotModel

_WORLDS, _SEED = 500, 820_000
_CURRENTS, _CURRENTS_SEED = 100, 830_000
_ARMS = ("planar", "macro", "so101", "ur5e")
_RIGHT: Sequence[tuple[FrictionKind, FrictionKind]] = (("coulomb", "coulomb"), ("load", "load"))
_WRONG: Sequence[tuple[FrictionKind, FrictionKind]] = (
    ("load", "coulomb"), ("stribeck", "coulomb"), ("load", "stribeck"), ("stribeck", "load"),
)  # fmt: skip
"""Kind of the world, and the one that is fitted."""
_PERIOD = 4e-3  # s
FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class World:
    """What was found in a world: shares of determined sums that are covered, and whether anything was flagged."""

    right: bool
    logs: int
    covered: float
    sums: int
    flagged: bool
    label: str


def main() -> bool:
    """Print the shares; return whether each lies in the wanted range."""
    worlds = int(os.environ.get("WORLDS", _WORLDS))
    print(f"{worlds} worlds, seeds {_SEED} to {_SEED + worlds - 1}")
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        found = list(pool.map(examine_world, range(_SEED, _SEED + worlds), chunksize=4))
    met = True
    for right, few in ((True, False), (True, True), (False, False)):
        own = [world for world in found if world.right == right and (not few or world.logs == 1)]
        if not own:
            continue
        share = float(np.mean([world.covered for world in own]))
        flagged = float(np.mean([world.flagged for world in own]))
        kind = f"kind {'right' if right else 'wrong'}{', one log' if few else ''}"
        good = (0.93 <= share <= 0.97 and flagged <= 0.05) if right else (share >= 0.85 and flagged >= 0.9)
        met &= good or few
        words = "" if few else ": met" if good else ": MISSED"
        print(f"  {kind:22} {len(own):4} worlds, covered {share:6.1%}, flagged {flagged:6.1%}{words}")
    for label in sorted({world.label for world in found}):
        own = [world for world in found if world.label == label]
        shares = [float(np.mean([getattr(world, name) for world in own])) for name in ("covered", "flagged")]
        print(f"    {label:40} {len(own):4}  {shares[0]:6.1%} {shares[1]:6.1%}")
    met &= _report_currents()
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"  CPU time: {(used.ru_utime + used.ru_stime) / 60.0:.1f} min")
    return met


def _report_currents() -> bool:
    print(f"{_CURRENTS} worlds with currents, seeds {_CURRENTS_SEED} to {_CURRENTS_SEED + _CURRENTS - 1}")
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        found = np.array(list(pool.map(examine_currents, range(_CURRENTS_SEED, _CURRENTS_SEED + _CURRENTS))))
    constants, sums, _ = np.nanmean(found, axis=0)  # NaN where the logs tell none
    good = bool(min(constants, sums) >= 0.93)
    print(f"  torque constants covered {constants:6.1%}, other sums {sums:6.1%}{': met' if good else ': MISSED'}")
    print(f"  median error of a torque constant: {np.nanmedian(found[:, 2]):.2%}")
    return good


def examine_currents(seed: int) -> tuple[float, float, float]:
    """Return the shares of torque constants and of other sums that are covered, and the constants' median error."""
    random = np.random.default_rng(seed)
    arm = str(random.choice(_ARMS))
    model, sums = _model(arm), _sums(arm)
    base = _true_sums(random, model, sums)
    drawn = _Friction(random, model, "coulomb", base, sums)
    gains = np.exp(random.uniform(-0.4, 0.4, model.nq))
    payload = FixedPayload(mass=float(random.uniform(0.05, 0.3) * model.inertial_parameters[::10].sum()))
    logs = [_log(random, arm, drawn, 0.0, 0.01, number, each, gains) for number, each in enumerate((None, payload))]
    fit = fit_logs(logs, "coulomb", currents=range(model.nq))
    layout, halves = fit.state.layout, second_method(fit).halves
    wanted = np.concatenate([base, drawn.values("coulomb")])
    known = [place for place in fit.taken if place < len(wanted) and _is_alone(fit, place)]
    hit = np.abs(fit.state.values[known] - wanted[known]) <= halves[known]
    places = [place for place in fit.taken if layout.constants <= place < layout.delay]
    errors = (fit.state.scales / gains - 1.0)[[layout.currents[place - layout.constants] for place in places]]
    covered = np.abs(errors) <= halves[places]
    return _share(covered), _share(hit), float(np.median(np.abs(errors))) if places else float("nan")


def _share(values: NDArray[np.bool_]) -> float:
    """Return the share that is true; NaN without values."""
    return float(np.mean(values)) if len(values) else float("nan")


@cache
def _model(arm: str) -> RobotModel:
    return validate(compose([f"robot={arm}"])).arm.model


@cache
def _sums(arm: str) -> list[ParameterSum]:
    return base_sums(_model(arm), True)


def examine_world(seed: int) -> World:
    """Return the coverage and the flags of a world."""
    random = np.random.default_rng(seed)
    arm = str(random.choice(_ARMS))
    right = seed % 3 != 0
    truth, fitted = _draw(random, _RIGHT if right else _WRONG)
    count = int(random.integers(1, 4)) if right else 3
    model, sums = _model(arm), _sums(arm)
    base = _true_sums(random, model, sums)
    drawn = _Friction(random, model, truth, base, sums)
    delay = float(random.uniform(0.0, 8e-3))
    size = float(random.uniform(0.005, 0.03))
    logs = [_log(random, arm, drawn, delay, size, number) for number in range(count)]
    fit = fit_logs(logs, fitted)
    wanted = np.concatenate([base, drawn.values(fitted) if right else np.full(model.nq * len(TERMS[fitted]), np.nan)])
    known = [place for place in fit.taken if place < len(wanted) and np.isfinite(wanted[place])]
    known = [place for place in known if _is_alone(fit, place)]
    hit = np.abs(fit.state.values[known] - wanted[known]) <= second_method(fit).halves[known]
    flags = find_flags(fit, logs)
    label = f"{truth} as {fitted}, {count} logs, {arm}"
    return World(right, count, float(hit.mean()), len(known), bool(flags), label)


def _true_sums(random: np.random.Generator, model: RobotModel, sums: Sequence[ParameterSum]) -> FloatArray:
    """Return drawn values of the base parameters of an arm."""
    full = np.concatenate([model.inertial_parameters, random.uniform(0.05, 0.5, model.nq)])
    full = full * random.uniform(0.7, 1.3, len(full))
    return np.array([each.factors for each in sums]) @ full


def _is_alone(fit: Fit, place: int) -> bool:
    """Return True for a sum that stands for no column that the logs do not tell."""
    own = fit.factors[fit.taken.index(place)]
    return int(np.count_nonzero(np.abs(own) > 1e-3)) == 1


def _draw(
    random: np.random.Generator, pairs: Sequence[tuple[FrictionKind, FrictionKind]]
) -> tuple[FrictionKind, FrictionKind]:
    return pairs[int(random.integers(len(pairs)))]


class _Friction:
    """Friction of the joints of a world, of the size of a fifth of the torques."""

    def __init__(
        self,
        random: np.random.Generator,
        model: RobotModel,
        kind: FrictionKind,
        base: FloatArray,
        sums: Sequence[ParameterSum],
    ) -> None:
        self.kind, self.base, self.sums = kind, base, sums
        typical = np.abs(_rigid(model, base, sums, *_waves(random, model, np.arange(0.0, 5.0, 0.05)))).mean(axis=0)
        self.typical = np.maximum(typical, 0.1 * typical.max())
        nq = model.nq
        self.viscous = self.typical * random.uniform(0.03, 0.15, nq)
        self.coulomb = self.typical * random.uniform(0.05, 0.2, nq)
        self.offset = self.typical * random.uniform(-0.03, 0.03, nq)
        self.by_load = random.uniform(0.05, 0.2, nq)
        self.stribeck = self.coulomb * random.uniform(0.4, 1.0, nq)
        self.slow = random.uniform(0.2, 0.5, nq)  # rad/s

    def torque(self, v: FloatArray, rigid: FloatArray) -> FloatArray:
        """Return the friction torques, shape (N, nq)."""
        sign = np.sign(v)
        found: FloatArray = self.viscous * v + self.coulomb * sign + self.offset
        if self.kind == "load":
            found = found + self.by_load * np.abs(rigid) * sign
        if self.kind == "stribeck":
            found = found + self.stribeck * np.exp(-np.abs(v) / self.slow) * sign
        return found

    def values(self, kind: FrictionKind) -> FloatArray:
        """Return the coefficients in the order of a fit of the same kind."""
        terms = {
            "viscous": self.viscous,
            "coulomb": self.coulomb,
            "offset": self.offset,
            "coulomb by load": self.by_load,
        }
        return np.column_stack([terms[term] for term in TERMS[kind]]).ravel()


def _waves(random: np.random.Generator, model: RobotModel, t: FloatArray) -> list[FloatArray]:
    shape = (3, model.nq)
    swing, speeds, phases = (random.uniform(*ends, shape) for ends in ((0.2, 0.6), (0.8, 5.0), (0.0, 2.0 * np.pi)))
    swing = np.where(model.prismatic, 0.3 * swing, swing)
    angles = t[:, None, None] * speeds + phases
    waves = (np.sin(angles), speeds * np.cos(angles), -(speeds**2) * np.sin(angles))
    return [np.sum(swing * wave, axis=1) for wave in waves]


def _rigid(
    model: RobotModel, base: FloatArray, sums: Sequence[ParameterSum], q: FloatArray, dq: FloatArray, ddq: FloatArray
) -> FloatArray:
    zeros = np.zeros_like(q)
    motion = EvenRows(model, 1.0, 1.0, q, dq, ddq, np.sign(dq), zeros, zeros[0], model.nq * ("",))
    Y = np.concatenate([motion.regressor(), ddq[:, :, None] * np.eye(model.nq)], axis=2)
    return np.asarray(Y[:, :, [each.column for each in sums]] @ base)


def _log(
    random: np.random.Generator,
    arm: str,
    drawn: _Friction,
    delay: float,
    size: float,
    number: int,
    payload: FixedPayload | None = None,
    gains: FloatArray | float = 1.0,
) -> LogRows:
    model, t = _model(arm), np.arange(0.0, float(random.uniform(20.0, 40.0)), _PERIOD)
    state = random.bit_generator.state
    q = _waves(random, model, t)[0]
    random.bit_generator.state = state  # the same motion, seen by the torques a delay later
    late = _waves(random, model, t - delay)
    rigid = _rigid(model, drawn.base, drawn.sums, *late)
    if payload is not None:
        zeros = np.zeros_like(late[0])
        signs = np.sign(late[1])
        motion = EvenRows(model, 1.0, 1.0, *late, signs, zeros, zeros[0], model.nq * ("",))
        rigid = rigid + payload_torques(motion, payload)
    torques = rigid + drawn.torque(late[1], rigid)
    scale = size * torques.std(axis=0)
    slow, kept = np.zeros(model.nq), float(np.exp(-_PERIOD / 0.08))
    noise = random.normal(size=torques.shape)
    for row in noise:  # half of the noise is correlated over 0.08 s
        slow = kept * slow + np.sqrt(1.0 - kept**2) * random.normal(size=model.nq)
        row += slow
    q = q + 2e-5 * random.normal(size=q.shape)
    motion = motion_of(model, q, (torques + scale * noise) / gains, _PERIOD, cutoff(_PERIOD))
    return log_rows(motion, drawn.sums, True, f"log {number + 1}", payload)
