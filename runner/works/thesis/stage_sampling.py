"""How slowly each stage of the combined arm may be sampled, against the closed forms."""

from collections.abc import Mapping, Sequence

import numpy as np

from runner.reporting.document import Block, Curves, FloatArray, Formula, Panel, Section, Series, Table, Text
from runner.reporting.figures import columns, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Condition, Measured
from runner.reporting.quantities import number
from runner.reporting.run_values import clock, failures
from runner.store import Run
from runner.works.thesis.plan import DYNAMICS, EULER_PERIODS, MACRO_PERIODS, MINI_PERIODS

_SHOWN = (MINI_PERIODS[2], MINI_PERIODS[4], MINI_PERIODS[5])
_FLOOR, _CEILING = 1e-13, 1e-2  # m, within which a decay or growth is exponential
_STEP = 1e-3  # m, the goal step
_STILL = 1e-9  # m per period: what is left of a decay


def stage_sampling_section(runs: Mapping[str, Run]) -> Section:
    """Return the largest stable periods of Macro and Mini, coupled and decoupled, beside the closed forms."""
    ours = {name: run for name, run in runs.items() if name.startswith("stage_sampling/")}
    rates = {
        stage: _natural_frequency(runs[f"stage_sampling/{stage}/coupled/{h}"], stage)
        for stage, h in (("macro", MACRO_PERIODS[0]), ("mini", MINI_PERIODS[0]))
    }
    cases: list[tuple[str, str, int | None, tuple[float, ...]]] = [
        ("macro", "macro", None, MACRO_PERIODS),
        ("mini", "mini", None, MINI_PERIODS),
        *((f"euler{steps}", "mini", steps, periods) for steps, periods in EULER_PERIODS.items()),
    ]
    rows: list[list[str]] = []
    kept: list[Condition] = []
    for case, stage, steps, periods in cases:
        limit = _limit(steps) / rates[stage]
        plant = "Runge-Kutta" if steps is None else f"Euler, {steps} step{'s' if steps > 1 else ''} per period"
        found = {d: _bracket(runs, case, stage, d, periods) for d in DYNAMICS}
        for d in DYNAMICS:
            kept += _holds(limit, *found[d], f"{stage}, {plant}, {d}")
        rows.append([stage, plant, number(1e3 * limit), *(_range(*found[d]) for d in DYNAMICS)])
    blocks: list[Block] = [
        Text(
            "One-way control, a goal step of a millimetre, no noise and no torque limit. One stage's period is "
            "varied, the other's stays at (or next to) its own; each Macro period is a multiple of the Mini's. A "
            "torque held over the period h takes the state $(x, dot(x))$ of a stage's tip to"
        ),
        Formula(
            "mat(1 - k_p c h^2, h - k_v c h^2; - k_p h, 1 - k_v h) vec(x, dot(x)), quad c = 1/2 (1 + 1/n)",
            "one period's state transition with gains k p and k v, where c is one half times one plus one over n",
        ),
        Text(
            "with n semi-implicit Euler steps in a period, $n -> infinity$ for exact integration. Stability ends "
            "where an eigenvalue passes $-1$."
        ),
        Table(
            "Largest stable period in ms: the closed form, and the simulation between the last period tried that "
            "decays and the first that grows.",
            ["stage varied", "plant", "closed form", *DYNAMICS],
            rows,
            (2,),
            origin(runs[f"stage_sampling/macro/coupled/{MACRO_PERIODS[0]}"]),
        ),
        _finding(runs, rates, kept),
        _curves(runs, rates["macro"]),
        *_expected_failures(ours),
    ]
    return Section("Sample times of both stages", blocks)


def _natural_frequency(run: Run, stage: str) -> float:
    return float(run.config["controller"]["natural_frequency"][stage])


def _limit(steps: int | None) -> float:
    """Return the largest stable omega_n h for xi = 1: the root of 4 - 4 w - w^2 / n."""
    return 1.0 if steps is None else float(2.0 * (np.sqrt(steps**2 + steps) - steps))


def _predicted(w: float) -> float:
    """Return the growth per period under exact integration, xi = 1, w = omega_n h."""
    transition = np.array([[1.0 - w**2 / 2.0, 1.0 - w], [-(w**2), 1.0 - 2.0 * w]])
    return float(np.abs(np.linalg.eigvals(transition)).max())


def _changes(run: Run, stage: str) -> FloatArray:
    """Return how far the stage's end point moves in each of its periods, in m: it has no rest value to subtract."""
    t = clock(run)
    period = float(run.config["controller"]["period"][stage])
    every = max(1, round(period / float(np.diff(t).min()))) if len(t) > 1 else 1
    error = columns(run.trace, "macro_error" if stage == "macro" else "error")[::every]
    distance: FloatArray = np.linalg.norm(np.diff(error, axis=0), axis=1)
    return distance


def _grows(run: Run, stage: str) -> bool:
    changes = _changes(run, stage)
    if run.status == "failed" or len(changes) < 8:
        return run.status == "failed"
    quarter = len(changes) // 4
    late, early = changes[-quarter:].max(), changes[quarter : 2 * quarter].max()
    return bool(late > _STILL and (late > early or late > _STEP))


def _growth(run: Run, stage: str) -> float:
    """Return the measured growth per period, NaN where the trace is too short for it."""
    changes = _changes(run, stage)
    index = np.arange(len(changes))
    good = (index >= 4) & (changes > _FLOOR) & (changes < _CEILING)
    if good.sum() < 6:
        return float("nan")
    last = index[good][len(index[good]) // 2 :]
    return float(np.exp(np.polyfit(last, np.log(changes[last]), 1)[0]))


def _bracket(
    runs: Mapping[str, Run], case: str, stage: str, dynamics: str, periods: tuple[float, ...]
) -> tuple[float | None, float | None]:
    """Return the longest period before the first one that grows, and that one, in s."""
    last = None
    for h in periods:
        if _grows(runs[f"stage_sampling/{case}/{dynamics}/{h}"], stage):
            return last, h
        last = h
    return last, None


def _holds(limit: float, last: float | None, first: float | None, case: str) -> tuple[Condition, Condition]:
    """Return the conditions that the last period that decays lies below the closed form, the first that grows above."""
    closed = Measured(f"closed form ({case})", 1e3 * limit, "ms")
    decays = Measured(f"last period that decays ({case})", None if last is None else 1e3 * last, "ms")
    grows = Measured(f"first period that grows ({case})", None if first is None else 1e3 * first, "ms")
    return decays <= closed, grows >= closed


def _range(last: float | None, first: float | None) -> str:
    if first is None:
        return "no growth" if last is None else f"above {number(1e3 * last)}"
    return f"below {number(1e3 * first)}" if last is None else f"{number(1e3 * last)} to {number(1e3 * first)}"


def _finding(runs: Mapping[str, Run], rates: Mapping[str, float], kept: Sequence[Condition]) -> Finding:
    """Return whether the closed forms give the limits, and the decay below the limit, on both plants."""
    h = MACRO_PERIODS[4]
    predicted = Measured("factor of a period, closed form", _predicted(rates["macro"] * h))
    coupled, decoupled = (
        Measured(f"factor of a period, {d}", _growth(runs[f"stage_sampling/macro/{d}/{h}"], "macro")) for d in DYNAMICS
    )
    factors = [number(factor.value, 4) for factor in (predicted, decoupled, coupled)]
    return finding(
        "The closed forms of one arm hold for both stages, riding on each other or not",
        f"The thesis' periods lie a factor of {number(1.0 / (rates['macro'] * MACRO_PERIODS[0]), 2)} (Macro) and "
        f"{number(1.0 / (rates['mini'] * MINI_PERIODS[0]), 2)} (Mini) below the limit. At a Macro period of "
        f"{number(1e3 * h)} ms a deviation is multiplied by {factors[0]} in each period by the closed form, by "
        f"{factors[1]} on the decoupled plant and by {factors[2]} on the coupled one: riding on each other does not "
        "move the limit of this arm.",
        *kept,
        coupled.near(predicted, 0.01),
        decoupled.near(predicted, 0.01),
    )


def _curves(runs: Mapping[str, Run], rate: float) -> Curves:
    h = np.array(MACRO_PERIODS)
    fine = np.linspace(0.8 * h[0], h[-1], 200)
    growth = [Series("closed form", 1e3 * fine, np.array([_predicted(rate * x) for x in fine]), color=2)]
    measured = np.array([_growth(runs[f"stage_sampling/macro/coupled/{x}"], "macro") for x in MACRO_PERIODS])
    growth.append(Series("coupled", 1e3 * h, measured, "points", color=0))
    errors = []
    for period in _SHOWN:
        run = runs[f"stage_sampling/mini/coupled/{period}"]
        error = np.linalg.norm(columns(run.trace, "error"), axis=1)
        t = clock(run)
        shown = (t <= 0.35) & np.isfinite(error) & (error > 0.0)
        errors.append(Series(f"h = {1e3 * period:g} ms", t[shown], error[shown]))
    return Curves(
        "Left: by how much a deviation of the Macro grows in each of its periods. Right: the tip error of the "
        "coupled arm at three Mini periods.",
        (
            Panel("Macro", "Macro period (ms)", "growth per period", growth),
            Panel("Mini", "time (s)", "tip error norm (m)", errors, y_log=True, y_range=(1e-9, 10.0)),
        ),
        2,
        origin(runs[f"stage_sampling/macro/coupled/{MACRO_PERIODS[-1]}"]),
    )


def _expected_failures(ours: Mapping[str, Run]) -> list[Block]:
    """Return a sentence on the runs that diverge above the limit, and a notice where one fails below it."""
    failed = {name: run for name, run in ours.items() if run.status == "failed"}
    below = {}
    for name, run in failed.items():
        case, h = name.split("/")[1], float(name.split("/")[3])
        stage = "macro" if case == "macro" else "mini"
        steps = int(case.removeprefix("euler")) if case.startswith("euler") else None
        if h < _limit(steps) / _natural_frequency(run, stage):
            below[name] = run
    text = f"{len(failed) - len(below)} of the {len(ours)} runs lie above the limit and end as diverged."
    return [Text(text), *failures(below)]
