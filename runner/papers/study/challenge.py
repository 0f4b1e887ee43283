"""Challenge of a study: the written condition of each finding, asked anew with one choice changed at a time.

Every variation has fresh seeds and few repetitions. The asked case with these comes first; values of a finer step are
compared with it.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from runner import store
from runner.assembly.run_config import RunConfig
from runner.base import progress
from runner.base.dotted_keys import get
from runner.base.errors import ConfigError, RunnerError
from runner.base.quantities import ROUNDING
from runner.config.compose.composer import Composer
from runner.papers.study.asked import AskedFinding, list_asked
from runner.papers.study.chapters import Chapters
from runner.papers.study.items import Way, listed, make_listed
from runner.papers.study.measured import Condition
from runner.papers.study.results import Results
from runner.reporting.document import Document
from runner.statistics.scope import FEWEST
from runner.store import Run
from runner.store.drawn import draws_nothing
from runner.sweeps.challenge.case import Case, check_sides, own_overrides
from runner.sweeps.challenge.families import FAMILIES
from runner.sweeps.challenge.question import Class, LeftOutVariation, Side, Variation
from runner.sweeps.challenge.table import Values, list_variations, read_values
from runner.sweeps.job import check_job
from runner.sweeps.plan import Item

_MOVED = 0.1  # relative change of a value by a finer step that is said
_WIDER: Sequence[Class] = ("equivalent", "conditions")

Overrides = tuple[str, ...]
Answer = Literal["holds", "turns", "cannot be asked"]


@dataclass(frozen=True)
class FindingOutcome:
    """A finding under a variation.

    Attributes:
        kind: Class of the variation.
        family: Its family.
        label: What is changed, in words.
        answer: Whether the written condition still holds.
        why: The failed conditions with their values, or the reason why it cannot be asked; empty if it holds.
    """

    kind: Class
    family: str
    label: str
    answer: Answer
    why: str = ""


@dataclass(frozen=True)
class Challenged:
    """A finding with the outcomes of its variations.

    Attributes:
        number: Number of its section.
        title: Its title.
        outcomes: The outcomes, in the order of the classes.
        left_out: Variations that do not apply to it.
        moved: Values that move by more than 10 % if the step is refined, in words.
    """

    number: str
    title: str
    outcomes: Sequence[FindingOutcome]
    left_out: Sequence[LeftOutVariation]
    moved: Sequence[str] = ()


def challenge_study(chapters: Chapters, document: Document, way: Way, chosen: str = "") -> list[Challenged]:
    """Return the findings of a study with the outcomes of all variations, whose missing runs are made.

    All findings and verdicts on printed numbers are asked under numerical choices. Answers of the report, and chosen
    findings, are also asked under equivalent choices and conditions if they compare values of two or more runs.

    Args:
        chapters: The chapters of the study, with their runs.
        document: Its report.
        way: Settings of the execution.
        chosen: Number of a section, or words of a title; empty for all findings.

    Raises:
        RunnerError: if there is no such finding.
        ConfigError: if the runs cannot be made.
    """
    return _Challenge(chapters, list_asked(chapters, document, chosen), way).run()


class _Challenge:
    """A challenge of some findings.

    Args:
        chapters: The chapters of the study, with their runs.
        asked: The findings.
        way: Settings of the execution.
    """

    def __init__(self, chapters: Chapters, asked: Sequence[AskedFinding], way: Way) -> None:
        self._chapters, self._asked, self._way = chapters, asked, way
        self._runs = chapters.runs
        self._own = chapters.study.jobs()
        self._values = read_values(way.config_dirs)
        self._loader = Composer(way.config_dirs)
        self._made: dict[Overrides, Run | str] = {}

    def run(self) -> list[Challenged]:
        """Return the findings with the outcomes of all variations."""
        progress.begin("listing variations")
        cases = [self._list(one) for one in self._asked]
        self._make(
            dict.fromkeys(
                self._changed(name, more)
                for one, (variations, _) in zip(self._asked, cases, strict=True)
                for variation in variations
                for name, more in zip(one.runs, variation.sides, strict=True)
            )
        )
        progress.begin("asking anew", len(cases), "findings")
        return [self._judge(one, *case) for one, case in zip(self._asked, cases, strict=True)]

    @cached_property
    def _sides(self) -> dict[str, Side]:
        names = dict.fromkeys(name for one in self._asked for name in one.runs)
        return {name: Side(name, own_overrides(self._own[name]), _medians(self._runs[name])) for name in names}

    @cached_property
    def _configs(self) -> Mapping[str, RunConfig]:
        configs = check_sides([*self._sides.values()], self._loader)
        return dict(zip(self._sides, configs, strict=True))

    def _list(self, one: AskedFinding) -> tuple[list[Variation], list[LeftOutVariation]]:
        """Return the variations of a finding, first the asked case on fresh seeds, and those that do not apply."""
        case = Case([self._sides[name] for name in one.runs], [self._configs[name] for name in one.runs])
        kinds = ("numbers", *_WIDER) if one.wider else ("numbers",)
        allowed = {name: some for name, some in self._values.items() if FAMILIES[name][0].kind in kinds}
        values: Values = {name: some for name, some in allowed.items() if name not in one.about}
        found, left = list_variations(case, values)
        left += [LeftOutVariation(name, "", "the finding compares it itself", "numbers") for name in one.about]
        if "seeds" in one.about:
            return [], left
        fresh = Variation("numbers", "seeds", "fresh", "fresh seeds", [[] for _ in one.runs])
        return [fresh, *found], left

    def _changed(self, name: str, more: Sequence[str]) -> Overrides:
        """Return the overrides of a run with a change, on fresh seeds if it draws anything."""
        config = self._runs[name].config
        draws = not draws_nothing(config)
        if draws or any(text.startswith("mismatch.spread") for text in more):
            repetitions = min(FEWEST, int(config["repetitions"])) if draws else FEWEST
            more = [*more, f"seed={self._seed}", f"repetitions={repetitions}"]
        return (*self._own[name], *more)

    @cached_property
    def _seed(self) -> int:
        """The first seed that no run of the study has."""
        return 1 + max(int(get(run.config, "seed")) for run in self._runs.values())

    def _make(self, wanted: Mapping[Overrides, None]) -> None:
        """Make the runs with some overrides; a run whose config is rejected is the reason instead."""
        items = {str(place): Item(own) for place, own in enumerate(wanted)}
        plan = listed(items, self._way, self._loader, "all" if self._chapters.study.manifest.traces else "never")
        good: list[int] = []
        progress.begin("checking variations", len(plan), "runs")
        for cell, own in enumerate(wanted):
            try:
                check_job(plan.composed(cell))
                good.append(cell)
            except ConfigError as error:
                self._made[own] = error.problems[0]
            progress.step()
        if not good:
            return
        made = make_listed(plan.only(good), map(str, good), self._way, self._loader)
        finished = store.Finished(self._way.outputs)
        for cell, own in enumerate(wanted):
            if own not in self._made:
                one = made[str(cell)]
                self._made[own] = one.missing or finished.open(one.place)

    def _judge(
        self, one: AskedFinding, variations: Sequence[Variation], left: Sequence[LeftOutVariation]
    ) -> Challenged:
        outcomes, moved, more = [], list[str](), list(left)
        asked: list[Condition] = []
        for variation in variations:
            changed = {
                name: self._made[self._changed(name, own)] for name, own in zip(one.runs, variation.sides, strict=True)
            }
            rejected = next((f"{name}: {run}" for name, run in changed.items() if isinstance(run, str)), "")
            if rejected:
                more.append(LeftOutVariation(variation.family, variation.value, rejected, variation.kind, True))
                continue
            runs = {name: run for name, run in changed.items() if isinstance(run, Run)}
            outcome, conditions = self._ask(one, variation, runs)
            outcomes.append(outcome)
            asked = asked or conditions
            if variation.family == "step":
                moved += list(_moved(asked, conditions))
        progress.step()
        return Challenged(one.number, one.title, outcomes, more, list(dict.fromkeys(moved)))

    def _ask(
        self, one: AskedFinding, variation: Variation, runs: Mapping[str, Run]
    ) -> tuple[FindingOutcome, list[Condition]]:
        old = self._runs
        results = Results({**old, **runs}, old.missing, old.dropped, old.parts)
        chapters = Chapters(self._chapters.study, results, self._chapters.calibrations)
        answer: Answer = "cannot be asked"
        try:
            conditions = one.ask(chapters)
        except RunnerError as error:
            return FindingOutcome(variation.kind, variation.family, variation.label, answer, str(error)), []
        failed = [each for each in conditions if not each.holds]
        lost = [name for name, run in runs.items() if run.status == "failed" and old[name].status != "failed"]
        why = "; ".join(f"{each.text}: {each.measured}" for each in failed)
        if not failed:
            answer = "holds"
        elif lost:
            why = f"{lost[0]} fails: {runs[lost[0]].failure}"
        elif not all(map(_is_without_values, failed)):
            answer = "turns"
        return FindingOutcome(variation.kind, variation.family, variation.label, answer, why), conditions


def _is_without_values(condition: Condition) -> bool:
    """Return whether a condition compares values none of which exists: neither side works there."""
    return len(condition.values) > 1 and all(each.value is None for each in condition.values)


def _moved(asked: Sequence[Condition], finer: Sequence[Condition]) -> Iterator[str]:
    """Yield the values that move by more than 10 % with a finer step, in words."""
    values = {each.name: each for condition in asked for each in condition.values}
    for after in (each for condition in finer for each in condition.values):
        before = values.get(after.name)
        if before is None or before.value is None or after.value is None:
            continue
        size = max(abs(before.value), abs(after.value))
        if size > ROUNDING and abs(after.value - before.value) > _MOVED * size:
            yield f"{after.name}: {before} to {after}"


def _medians(run: Run) -> dict[str, float]:
    known = {name: run.median(name) for name in run.metrics}
    return {name: value for name, value in known.items() if value is not None}
