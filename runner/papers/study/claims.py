"""Claims and statements of a study compared with stored runs, with verdicts, and claims changed after the result."""

from collections import Counter
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from runner.base.atomic import write_atomically
from runner.base.machine import today
from runner.base.quantities import format_range, quantity
from runner.metrics.positioning import STEADY_WINDOW
from runner.papers.reporting.claims import Claim, ClaimResult
from runner.papers.reporting.equation import EquationVerdict
from runner.papers.reporting.published_claims import (
    CLAIMS,
    CONTRADICTION,
    FACTOR,
    PublishedClaim,
    PublishedStatement,
    Simulated,
    Verdict,
    judge_motion,
    load_claims,
    scale_bound,
    verdict_on,
)
from runner.papers.study.measured import Measured
from runner.papers.study.results import MissingError
from runner.papers.study.study import Study
from runner.reporting.words import PLANT
from runner.statistics.spec import merge_histories, set_after
from runner.store import Run
from runner.store.seal import read_json, sealed_json

_DIGITS = 4  # at least as many as a source prints


def legend(claims: Sequence[PublishedClaim]) -> str:
    """Return the meanings of the verdicts on the kinds of claims that a study has."""
    numbers, motions = [claim for claim in claims if claim.metric], [claim for claim in claims if claim.extents]
    told = []
    if numbers:
        told += [
            f"A printed number matches when the simulated median lies within a factor of {FACTOR:g} of it; else that "
            "is smaller or larger than printed, larger also when most repetitions have no value. A run that failed "
            "leaves it undecided."
        ]
    if any(claim.like for claim in numbers):
        told += ["A comparison in words matches within the same factor, and differs otherwise."]
    if any(claim.bound for claim in numbers):
        told += ["The source contradicts itself where another of its numbers, so widened, stays below the printed one."]
    if motions:
        told += [
            "A stated motion matches when the tip follows it to half a unit of the last printed digit, and differs "
            "otherwise. The source contradicts itself where the path that it prescribes is another motion."
        ]
    if any(claim.fails for claim in motions):
        told += ["A stated failure matches when the simulation fails, too."]
    return " ".join(told)


def judged_claims(claims: Sequence[PublishedClaim], runs: Mapping[str, Run], presets: Mapping[str, str]) -> list[Claim]:
    """Return each claim with what the runs say of it, under each preset.

    Args:
        claims: All claims of a study: a bound of one names another.
        runs: The stored runs of the study, by names such as "figure_3_5/full_equations"; see Simulation.
        presets: Names of the presets under which they are judged, with their words; where there are none, once.

    Raises:
        MissingError: if a claim's run was not made, or one that it is compared with gave no value.
    """
    return [_Claimed(claim, claims, runs, presets).block() for claim in claims]


def judge_number(
    claim: PublishedClaim, claims: Sequence[PublishedClaim], runs: Mapping[str, Run], preset: str
) -> tuple[Measured, Verdict]:
    """Return the median of a claim's number under a preset, and the verdict on it; "undecided" if its run failed.

    Raises:
        MissingError: if a run was not made, or there is nothing to compare with.
    """
    run = runs[run_name(claim.simulated_by[0], preset)]
    value = run.median(claim.metric) if claim.metric in run.metrics else None
    measured = Measured(f"claim {claim.number}", value, claim.unit)
    if run.status == "failed" or not claim.metric:
        return measured, "undecided"
    verdict = verdict_on(claim, claims, lambda name, metric: runs[run_name(name, preset)].median(metric))
    if verdict is None:
        raise MissingError(f"claim {claim.number}: there is nothing to compare it with under {preset}")
    return measured, verdict


def judged_statements(
    statements: Sequence[PublishedStatement], judged: Mapping[str, tuple[Verdict | EquationVerdict, str]]
) -> list[Claim]:
    """Return each statement with its verdict, numbered in order.

    Args:
        statements: All statements of a study.
        judged: Verdict on each by its name, and what was measured.

    Raises:
        ValueError: if another set of names is judged than is stated.
    """
    if {each.name for each in statements} != set(judged):
        raise ValueError(f"stated: {', '.join(each.name for each in statements)}; judged: {', '.join(judged)}")
    return [
        Claim(str(number), each.statement, each.place, "", (ClaimResult("", measured, verdict),), each.reason)
        for number, each in enumerate(statements, start=1)
        for verdict, measured in [judged[each.name]]
    ]


def run_name(name: str, preset: str) -> str:
    """Return the name of a run with its preset, or without one."""
    return f"{name}/{preset}" if preset else name


def _value(number: float) -> float | None:
    """Return a metric of one repetition; None without a value."""
    return None if np.isnan(number) else float(number)


class _Claimed:
    """One claim, with everything that decides its verdict.

    Args:
        claim: The claim.
        claims: All claims of its study.
        runs: The stored runs of its study, by name.
        presets: Names of the presets with their words.
    """

    def __init__(
        self,
        claim: PublishedClaim,
        claims: Sequence[PublishedClaim],
        runs: Mapping[str, Run],
        presets: Mapping[str, str],
    ) -> None:
        self._claim, self._claims, self._runs = claim, claims, runs
        self._presets = presets or {"": ""}

    def block(self) -> Claim:
        """Return it with its verdicts."""
        claim = self._claim
        first = self._run(claim.simulated_by[0], next(iter(self._presets)))
        findings = [self._finding(preset) for preset in self._presets]
        return Claim(
            str(claim.number),
            claim.statement,
            claim.place,
            _printed(claim),
            findings,
            self._reason(),
            str(first.provenance["command"]),
        )

    def _finding(self, preset: str) -> ClaimResult:
        claim, run, words = self._claim, self._run(self._claim.simulated_by[0], preset), self._presets[preset]
        failed = run.status == "failed"
        if claim.extents:
            shown = run.failure or "" if failed else self._moved(run)
            return ClaimResult(preset, shown, self._of_motion(run), words)
        verdict = self._of_number(partial(self._median, preset), preset)
        if failed:
            undecided: Verdict = verdict if verdict == CONTRADICTION else "undecided"
            return ClaimResult(preset, run.failure or "", undecided, words)
        return ClaimResult(
            preset, run.metrics[claim.metric].beside(claim.value), verdict, words, self._hangs(run, preset, verdict)
        )

    def _hangs(self, run: Run, preset: str, verdict: Verdict) -> dict[str, str]:
        """Return the conditions that a verdict on a number depends on, each with the result under another one."""
        claim, told = self._claim, dict[str, str]()
        alone = self._of_each_repetition(run, preset)
        error = run.plant_error or {}
        there = error.get("metrics", {}).get(claim.metric)
        first = _value(run.values(claim.metric)[0])
        if there is not None and (other := self._with(preset, there["value"])) != self._with(preset, first):
            told["the engine"] = f"repetition 0 on {PLANT[error['plant']]}: {self._shown(there['value'])}, {other}"
        others = Counter(other for other in alone if other != verdict)
        if others:
            told["the seed"] = ", ".join(
                f"{count} of {len(alone)} single repetitions: {other}" for other, count in others.items()
            )
        if claim.longer and (text := self._lasting(run, preset, verdict)):
            told["the end of the run"] = text
        return told

    def _of_each_repetition(self, run: Run, preset: str) -> list[Verdict]:
        """Return the verdicts of single repetitions; what is compared with is of the same one, if it has as many."""
        count = len(run.values(self._claim.metric))

        def simulated(at: int, *key: str) -> float | None:
            values = self._run(key[0], preset).values(key[1])
            return _value(values[at]) if len(values) == count else self._median(preset, *key)

        return [self._of_number(partial(simulated, at), preset) for at in range(count)]

    def _lasting(self, run: Run, preset: str, verdict: Verdict) -> str:
        """Return the effect of a longer run on a claim's number; empty if it has none."""
        longer = self._run(self._claim.longer, preset)
        value = longer.median(self._claim.metric)
        (end, lost), (_, own_lost) = map(_reach_lost, (longer, run))
        over, other = f"over {quantity(end, 's')}", self._with(preset, value)
        if other != verdict:
            return f"{over}: {self._shown(value)}, {other}"
        gone = lost - own_lost > STEADY_WINDOW and verdict != "larger than printed"
        return f"{over} the target is out of reach for {quantity(lost - own_lost, 's')} more" if gone else ""

    def _shown(self, value: float | None) -> str:
        return "no value" if value is None else quantity(value, self._claim.unit)

    def _with(self, preset: str, value: float | None) -> Verdict:
        """Return the verdict if another value replaces the claim's own."""
        own = self._claim.simulated_by
        return self._of_number(lambda *key: value if key == own else self._median(preset, *key), preset)

    def _of_motion(self, run: Run) -> Verdict:
        tip, desired = run.vector("tip"), run.vector("desired")
        return judge_motion(self._claim.extents, self._claim.fails, tip, desired)

    def _moved(self, run: Run) -> str:
        """Return the range of the tip along each axis of the claim, in m."""
        tip = run.vector("tip")
        paths = {extent.axis: tip[:, "xyz".index(extent.axis)] for extent in self._claim.extents}
        return ", ".join(f"{axis} {path.min():.4f} to {path.max():.4f} m" for axis, path in paths.items())

    def _of_number(self, simulated: Simulated, preset: str) -> Verdict:
        verdict = verdict_on(self._claim, self._claims, simulated)
        if verdict is None:
            raise MissingError(f"claim {self._claim.number}: there is nothing to compare it with under {preset}")
        return verdict

    def _median(self, preset: str, name: str, metric: str) -> float | None:
        return self._run(name, preset).median(metric)

    def _reason(self) -> str:
        claim, told = self._claim, [self._claim.reason]
        if claim.bound is not None:
            found = {
                preset: scale_bound(claim.bound, self._claims, partial(self._median, preset))
                for preset in self._presets
            }
            times = " and ".join(f"{quantity(one, claim.unit)}{self._under(preset)}" for preset, one in found.items())
            told = [f"{claim.bound.reason} {claim.bound.name} is {times}."]
        if claim.metric == "steady_state_error":
            told += [self._late(preset) for preset in self._presets]
        return " ".join(text for text in told if text)

    def _late(self, preset: str) -> str:
        """Return the number of repetitions that have not settled at the end; empty if all have."""
        run = self._run(self._claim.simulated_by[0], preset)
        band = float(run.config["robot"]["settling_band"])
        errors = run.values("steady_state_error") if "steady_state_error" in run.metrics else np.zeros(0)
        late = np.count_nonzero(errors > band)
        if not late:
            return ""
        told = f"{late} of {len(errors)} repetitions{self._under(preset)}"
        return f"{told} are beyond {quantity(band, 'm')} in the last half second."

    def _under(self, preset: str) -> str:
        return f" ({self._presets[preset]})" if preset else ""

    def _run(self, name: str, preset: str) -> Run:
        return self._runs[run_name(name, preset)]


def _reach_lost(run: Run) -> tuple[float, float]:
    """Return when a run ends, and how long its target is out of a stage's reach, in s."""
    end = float(run.t[-1])
    return end, end * (run.median("reach_loss_fraction") or 0.0)


def _printed(claim: PublishedClaim) -> str:
    if not claim.printed:
        return "in words"
    low, high = claim.printed[0], claim.printed[-1]
    return quantity(high, claim.unit, _DIGITS) if low == high else format_range(low, high, claim.unit)


_JUDGED_BY = {"printed", "metric", "extents", "fails", "bound", "like"}


def late_claims(outputs: Path, study: Study, runs: Mapping[str, Run], date: str = "") -> list[str]:
    """Return a line for each claim that was changed after these runs were first judged: the date and the old values.

    The judged fields of each claim are stored in `claims/NAME.json` of the outputs folder with this date, or with
    today's if it is empty. A claim whose run is missing is not judged.

    Raises:
        StoreError: if the file is damaged, or the disk does not take it.
    """
    path, late = outputs / "claims" / f"{study.name}.json", []
    known = read_json(path, "remove it to forget what claims were judged by").get("claims", {}) if path.exists() else {}
    for claim in load_claims(study.folder) if (study.folder / CLAIMS).is_file() else ():
        names = [run_name(claim.simulated_by[0], preset) for preset in study.manifest.presets or ("",)]
        if all(name in runs for name in names):
            value = claim.model_dump(mode="json", include=_JUDGED_BY)
            value["like"] = claim.like and claim.like.model_dump(exclude_defaults=True)
            key = " ".join([str(claim.number), *(runs[name].hash for name in names)])
            known = merge_histories(known, {key: [[date or today(), value]]})
            when, before = set_after(known[key], value)
            changed = {name: old for name, old in (before[-1] if before else {}).items() if old != value[name]}
            told = ", ".join(f"{name}: {old}" for name, old in changed.items())
            late += (
                [f"claim {claim.number} was set after the result was known ({when}; before: {told})"] if when else []
            )
    if known:
        write_atomically(path, sealed_json({"claims": known}))
    return late
