"""Time offsets of made-up logs: whether each is found, undetermined, or wrong; and whether flipped joints are refused.

A log is a run's motion with another zero of time, behind a lag of the arm, with noise, of 5 to 60 s at 50 Hz to 1 kHz.
It starts and ends at rest, or is cut off in motion: as long as the run, or shorter. Its joints move at many speeds, at
one each, or all at one. With commands in the log the offset is that of the commands; without, the lag is part of it.
"""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from runner.base.errors import RunnerError
from runner.recordings.offset import Offset, find_offset

LOGS = 200
_TOLERANCE = 1e-3  # s
_MOST_UNDETERMINED = 0.1
_REST = 1.0  # s, before and after a motion that starts and ends at rest
_PERIOD = 2e-3  # s, of the run
FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class MadeLog:
    """A log and a run; `start` is what is to be found, in s."""

    t: FloatArray
    recorded: FloatArray
    run_t: FloatArray
    simulated: FloatArray
    start: float
    at_rest: bool


def main() -> bool:
    """Print both tables; return whether no offset is wrong, few are undetermined and each flipped joint is refused."""
    counts: Counter[tuple[bool, str]] = Counter()
    for seed in range(LOGS):
        log = make_log(seed)
        answer = judge(log)
        counts[log.at_rest, answer] += 1
        if answer not in ("right", "undetermined") or (log.at_rest and answer == "undetermined"):
            print(f"seed {seed}: {answer}")
    for at_rest, words in ((True, "starts or ends at rest"), (False, "cut off in motion")):
        print(f"{words:24}" + ", ".join(f"{answer} {n}" for (rest, answer), n in counts.items() if rest == at_rest))
    wrong = [seed for seed in range(LOGS) if not is_refused(make_log(seed, periodic=True), seed)]
    print(f"flipped joint in {LOGS} periodic logs: not refused {len(wrong)} {wrong[:5]}")
    right = sum(n for (_, answer), n in counts.items() if answer == "right")
    few = counts[False, "undetermined"] <= _MOST_UNDETERMINED * LOGS
    return right + counts[False, "undetermined"] == LOGS and few and not wrong


def make_log(seed: int, periodic: bool = False) -> MadeLog:
    """Return the log of a seed, all of whose joints move at one speed if it is to be periodic."""
    rng = np.random.default_rng(seed)
    lasts, rate = rng.uniform(5.0, 60.0), np.exp(rng.uniform(np.log(50.0), np.log(1000.0)))
    at_rest, commands, shorter = (rng.random(3) < 0.5).tolist()
    terms, common = (1, True) if periodic else ((3, False), (1, False), (1, True))[int(rng.integers(3))]
    path = _path(rng, lasts, terms, common, at_rest)
    lag, noise = rng.uniform(0.0, 0.05), 10.0 ** rng.uniform(-5.0, -3.5)
    run_t = np.arange(0.0, lasts, _PERIOD)
    start = rng.uniform(-0.3, 0.3) * lasts
    first, last = (
        (start - _REST, start + lasts + _REST)
        if at_rest
        else (start, start + lasts * (rng.uniform(0.5, 1.0) if shorter else 1.0))
    )
    t = np.arange(first, last, 1.0 / rate)
    later = 0.0 if commands else lag
    recorded = path(t - start - later)
    recorded = recorded + noise * rng.normal(size=recorded.shape) * (0.0 if commands else 1.0)
    return MadeLog(t - first, recorded, run_t, path(run_t), start + later - first, at_rest)


def _path(
    rng: np.random.Generator, lasts: float, terms: int, common: bool, at_rest: bool
) -> Callable[[FloatArray], FloatArray]:
    """Return positions over time, shape (N, joints); at rest they stand outside 0 s to `lasts`."""
    joints = int(rng.integers(2, 4))
    speeds = rng.uniform(0.5, 4.0) * np.ones((joints, 1)) if common else rng.uniform(0.3, 5.0, (joints, terms))
    swings, phases = rng.uniform(0.1, 0.5, (joints, terms)), rng.uniform(0.0, 2.0 * np.pi, (joints, terms))

    def path(t: FloatArray) -> FloatArray:
        inside = np.clip(t, 0.0, lasts) if at_rest else t
        edge = np.minimum(inside, lasts - inside) / min(1.0, 0.2 * lasts)
        ramp = np.clip(edge, 0.0, 1.0) if at_rest else np.ones(len(t))
        smooth = ramp**3 * (10.0 - 15.0 * ramp + 6.0 * ramp**2)
        return smooth[:, None] * np.sum(swings * np.sin(inside[:, None, None] * speeds + phases), axis=2)

    return path


def _find(log: MadeLog) -> Offset:
    names = [f"columns.q{place}" for place in range(log.recorded.shape[1])]
    return find_offset(log.t, log.recorded, log.run_t, log.simulated, names)


def judge(log: MadeLog) -> str:
    """Return whether its offset is right, undetermined, wrong or refused."""
    try:
        found = _find(log)
    except RunnerError as error:
        return f"refused: {error}"
    if found.rivals or found.open_ended:
        return "undetermined"
    off = found.start - log.start
    return "right" if abs(off) < _TOLERANCE else f"wrong by {1e3 * off:.3g} ms"


def is_refused(log: MadeLog, seed: int) -> bool:
    """Return whether a log is refused, or its offset undetermined, once one of its joints is flipped."""
    recorded = log.recorded.copy()
    recorded[:, seed % recorded.shape[1]] *= -1.0
    try:
        found = _find(MadeLog(log.t, recorded, log.run_t, log.simulated, log.start, log.at_rest))
    except RunnerError:
        return True
    return bool(found.rivals)
