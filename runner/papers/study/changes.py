"""Changes between two versions of a study: verdicts, findings, equations, caveats and numbers."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from runner.base.bounded_json import decode_json
from runner.base.errors import RunnerError
from runner.base.limits import RECORD, read_text
from runner.base.machine import equal_up_to_rounding

FILE = "conclusions.json"
"""Name of the file with a study's conclusions in the folder of its report."""

ROUNDED = "rounding"
"""Kind of a number that is equal up to rounding."""

KINDS = ("study", "verdict", "finding", "equation", "caveat", "measured", "words", "number", ROUNDED)
"""Kinds of changes, those that matter most first."""

Value = str | float | None


@dataclass(frozen=True)
class VersionChange:
    """A difference between two versions.

    Attributes:
        kind: One of KINDS.
        name: What it is, with the name of its study.
        old: What it was; None where there was none.
        new: What it is; None where there is none.
    """

    kind: str
    name: str
    old: Value
    new: Value

    @property
    def size(self) -> float:
        """Relative change of a number; infinite if the old value is 0 or one of them is not a number."""
        if not isinstance(self.old, float) or not isinstance(self.new, float) or self.old == 0.0:
            return float("inf")
        return abs(self.new / self.old - 1.0)


def read_conclusions(path: Path) -> Mapping[str, Any]:
    """Return the output of `runner reproduce --json`, from a file or from the folder of a report.

    Raises:
        RunnerError: if it cannot be read, or is something else.
    """
    file = path / FILE if path.is_dir() else path
    try:
        content = decode_json(read_text(file, RECORD))
    except (OSError, ValueError) as error:
        raise RunnerError(f"cannot read {file}: {error}; `runner reproduce NAME --json > FILE` writes one") from None
    if not isinstance(content, dict) or not all(
        isinstance(study, dict) and "title" in study for study in content.values()
    ):
        raise RunnerError(
            f"{file} does not hold the conclusions of studies; `runner reproduce NAME --json > FILE` does"
        )
    return content


def changes(old: Mapping[str, Any], new: Mapping[str, Any]) -> list[VersionChange]:
    """Return the differences of two versions, by kind, the largest changes of numbers first.

    Numbers that differ by no more than rounding have the kind ROUNDED; see `equal_up_to_rounding`.

    Args:
        old: Conclusions by the studies' names, also those of an earlier version of this package.
        new: The same of another version.
    """
    before, after = dict(_flat(old, new)), dict(_flat(new, old))
    found = [
        _change(kind, name, before.get((kind, name)), after.get((kind, name)))
        for kind, name in dict.fromkeys([*before, *after])
        if before.get((kind, name)) != after.get((kind, name))
    ]
    ranks = {kind: rank for rank, kind in enumerate(KINDS)}
    return sorted(
        found, key=lambda change: (ranks[change.kind], -change.size if change.kind in ("number", ROUNDED) else 0.0)
    )


def _change(kind: str, name: str, old: Value, new: Value) -> VersionChange:
    rounded = isinstance(old, float) and isinstance(new, float) and equal_up_to_rounding(old, new)
    return VersionChange(ROUNDED if rounded else kind, name, old, new)


def _flat(studies: Mapping[str, Any], others: Mapping[str, Any]) -> Iterator[tuple[tuple[str, str], Value]]:
    """Yield everything that is compared, by kind and name; of what the others do not have only that it is there."""
    for study, content in studies.items():
        yield ("study", study), str(content["title"])
        for part, tell in _PARTS.items():
            if part not in content or study not in others:
                continue
            if part not in others[study]:
                yield ("study", f"{study}: {part}"), "there"
                continue
            for kind, name, value in tell(content[part]):
                yield (kind, f"{study}: {name}"), value


_Told = Iterator[tuple[str, str, Value]]


def _verdicts(verdicts: Sequence[Mapping[str, Any]]) -> _Told:
    for claim in verdicts:
        for ours in claim["ours"]:
            name = f"claim {claim['claim']}{', ' if ours['preset'] else ''}{ours['preset']}"
            yield "verdict", name, ours["verdict"]
            yield "measured", name, ours["measured"]


def _findings(findings: Sequence[Mapping[str, Any]]) -> _Told:
    for finding in findings:
        yield "finding", finding["title"], "holds" if finding["holds"] else "no longer holds"
        yield "words", finding["title"], finding["text"]


def _equations(equations: Sequence[Mapping[str, Any]]) -> _Told:
    for equation in equations:
        yield "equation", f"{equation['number']}, {equation['place']}: {equation['title']}", equation["verdict"]


def _caveats(caveats: Sequence[Mapping[str, Any]]) -> _Told:
    for caveat in caveats:
        yield "caveat", f"{caveat['run']}: {caveat['rule']}", caveat["text"]


def _numbers(runs: Mapping[str, Any]) -> _Told:
    for run, told in runs.items():
        yield "number", f"{run} status", told["status"]
        yield from _summaries(run, told["metrics"])


def _calibrations(calibrations: Mapping[str, Any]) -> _Told:
    for name, told in calibrations.items():
        for table in ("estimates", "errors", "deviations"):
            yield from _summaries(f"{name} {table}", told[table])


def _summaries(name: str, metrics: Mapping[str, Any]) -> _Told:
    for metric, summary in metrics.items():
        for key in ("median", "min", "max"):
            value = summary[key]
            yield "number", f"{name} {metric} {key} ({summary['unit']})", None if value is None else float(value)


_PARTS: Mapping[str, Callable[[Any], _Told]] = {
    "verdicts": _verdicts,
    "findings": _findings,
    "equations": _equations,
    "caveats": _caveats,
    "numbers": _numbers,
    "calibrations": _calibrations,
}
