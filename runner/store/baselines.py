"""Baselines of `runner check`: bands for the metrics of a run; those of a sweep are in `cells`.

A file of bands is `{schema: 1, metrics: {NAME: {min:, max:, reason:, margin:}}}`. If `runner check --save-baseline`
finds such a file, it sets the ends of the bands again, from a sweep over the seed.
"""

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import yaml
from omegaconf import OmegaConf
from omegaconf.errors import OmegaConfBaseException
from pydantic import AfterValidator, Field, NonNegativeFloat, ValidationError

from runner.base.atomic import write_atomically
from runner.base.bounded_yaml import Bounds, YamlError, read_yaml
from runner.base.dotted_keys import dotted, leaves
from runner.base.errors import RunnerError, StoreError, nearest, unknown
from runner.base.limits import Limit, read_text
from runner.base.paths import studies_dir
from runner.config.compose.files import described_files
from runner.config.compose.messages import describe
from runner.plugins.metric_units import unit_of, units
from runner.schema.bound import Bound
from runner.schema.model import StrictModel
from runner.store import Run
from runner.store.cells import FORMER, FormerBaseline, SweepBaseline
from runner.store.record import Metric

SCHEMA = 1
_BOUNDS = Bounds(Limit(200_000_000, "bytes"), values=5_000_000)  # about 10^5 cells
_OTHER_MACHINES = 0.02  # relative; rounding differences between machines, over a whole run
_OF_SEEDS = re.compile(r"; \d+ seeds gave .*$", re.DOTALL)  # at the end of a reason
_FOLDER = "references"  # of a study


class Band(Bound):
    """Range that a metric's median must be in, ends included.

    Attributes:
        reason: Why the band has these ends.
        margin: Distance of the ends from the medians of the seeds, in the metric's unit; see `renew_bands`.
    """

    reason: Annotated[str, Field(min_length=1)]
    margin: NonNegativeFloat | None = None


def _check_schema(number: object) -> object:
    if number != SCHEMA:
        raise ValueError(f"must be {SCHEMA}")
    return number


def _check_metric(name: str) -> str:
    if unit_of(name) is None:
        known = units()
        raise ValueError(unknown("metric", name, known))
    return name


def _check_some(entries: dict[str, Any]) -> dict[str, Any]:
    if not any(entries.values()):
        raise ValueError("must have at least one metric")
    return entries


class _BandFile(StrictModel):
    schema_: Annotated[object, AfterValidator(_check_schema), Field(alias="schema")]
    metrics: Annotated[dict[Annotated[str, AfterValidator(_check_metric)], Band], AfterValidator(_check_some)]


@dataclass(frozen=True)
class Bands:
    """A baseline of runs.

    Attributes:
        name: Its name or path, for messages.
        bands: Band of each metric by name.
    """

    name: str
    bands: Mapping[str, Band]


@dataclass(frozen=True)
class BandResult:
    """Comparison of one metric of a run with its band.

    Attributes:
        metric: Name of the metric.
        value: Its median over the repetitions; None if the run has none.
        band: Its band.
        good: Whether the run did not fail and the value is in the band.
    """

    metric: str
    value: float | None
    band: Band
    good: bool


def load_baseline(path: Path, name: str = "") -> Bands | SweepBaseline:
    """Read a baseline of runs or of a sweep.

    Args:
        path: The file.
        name: Its name for messages; empty for its path.

    Raises:
        StoreError: if it cannot be read or is not a baseline; lists all its problems.
    """
    try:
        text = read_text(path, _BOUNDS.size)
        content = read_yaml(text, path, _BOUNDS)
        if not isinstance(content, dict):
            raise ValueError("it must have schema, and metrics or cells")
        if "cells" not in content:  # written by hand, so read like a config: 1e-3 is a number
            content = OmegaConf.to_container(OmegaConf.create(text), resolve=False)
    except YamlError as error:
        raise StoreError(f"baseline {error}") from error
    except (OSError, ValueError, OmegaConfBaseException) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise StoreError(f"cannot read the baseline {path}: {reason}") from error
    model: type[_BandFile | SweepBaseline | FormerBaseline] = _BandFile
    if "cells" in content:
        model = FormerBaseline if content.get("schema") == FORMER else SweepBaseline
    try:
        file = model.model_validate(content)
    except ValidationError as error:
        problems = [f"  - {problem}" for problem in describe("", model, error)]
        raise StoreError("\n".join([f"{path} is not a valid baseline:", *problems])) from None
    if isinstance(file, FormerBaseline):
        return file.renewed()
    return file if isinstance(file, SweepBaseline) else Bands(name or str(path), file.metrics)


def check_run(run: Run, baseline: Bands) -> list[BandResult]:
    """Compare the medians of a run with a baseline; every metric of a failed run is out of its band."""
    findings = []
    for metric, band in baseline.bands.items():
        value = run.metrics[metric].median if metric in run.metrics else None
        good = run.status == "ok" and value is not None and band.range.holds(value)
        findings.append(BandResult(metric, value, band, good))
    return findings


def renew_bands(bands: Bands, runs: Sequence[Run], path: Path) -> int:
    """Set the ends of the bands in a file from runs that differ only in the seed; return the number of bands.

    A band has the smallest and the largest of the runs' medians, and `margin` on both sides. Without `margin` it is
    half the interquartile range of all repetitions, some three standard errors of a median of 40, and 2 % of the
    largest median for the rounding of other machines. The file keeps its comments, its metrics and their reasons; a
    reason ends with the medians.

    Raises:
        StoreError: if the runs have fewer than two seeds, differ in another key, failed, or lack a median.
    """
    if len({run.config["seed"] for run in runs}) < 2:
        raise StoreError(f"{path} has bands, which need two or more seeds. Sweep the seed, such as 'seed=range(0,5)'.")
    configs = [{dotted(place): value for place, value in leaves(run.config)} | {"seed": None} for run in runs]
    known = dict.fromkeys(key for config in configs for key in config)
    if swept := [key for key in known if any(config.get(key) != configs[0].get(key) for config in configs)]:
        raise StoreError(f"{path} has bands, which need runs that differ only in the seed, not in {', '.join(swept)}.")
    if failed := [f"  - {run.folder}: {run.failure}" for run in runs if run.failure]:
        raise StoreError("\n".join(["a failed run cannot be in a baseline:", *failed]))
    if absent := [name for name in bands.bands if any(run.median(name) is None for run in runs)]:
        raise StoreError(f"{path}: some runs have no median of {', '.join(absent)}. Remove such bands from the file.")
    renewed = {name: _renewed(band, [run.metrics[name] for run in runs]) for name, band in bands.bands.items()}
    head = "".join(takewhile(lambda line: line.startswith("#"), read_text(path, _BOUNDS.size).splitlines(True)))
    text = yaml.safe_dump({"schema": SCHEMA, "metrics": renewed}, sort_keys=False, width=116, allow_unicode=True)
    write_atomically(path, f"{head}{text}".encode())
    return len(renewed)


def _renewed(band: Band, seeds: Sequence[Metric]) -> dict[str, Any]:
    medians = [seed.median for seed in seeds if seed.median is not None]
    low, high = min(medians), max(medians)
    margin = band.margin
    if margin is None:
        quartiles = np.nanpercentile(np.concatenate([seed.read() for seed in seeds]), [25, 75])
        margin = 0.5 * float(np.ptp(quartiles)) + _OTHER_MACHINES * high
    spread = f"{low:.4g}" if low == high else f"{low:.4g} to {high:.4g}"
    unit = "" if seeds[0].unit == "1" else f" {seeds[0].unit}"
    ends = {
        "min": max(0.0, _to_three_digits(low - margin, math.floor)),
        "max": _to_three_digits(high + margin, math.ceil),
    }
    reason = f"{_OF_SEEDS.sub('', band.reason)}; {len(seeds)} seeds gave {spread}{unit}"
    kept = {end: value for end, value in ends.items() if getattr(band, end) is not None}
    return {**kept, "reason": reason} | ({} if band.margin is None else {"margin": band.margin})


def _to_three_digits(value: float, direction: Callable[[float], int]) -> float:
    digits = 2 - math.floor(math.log10(abs(value) or 1.0))
    return round(direction(value * 10.0**digits) / 10.0**digits, digits)


def shipped_baselines() -> dict[str, str]:
    """Return the names of the bundled baselines, sorted, each with the first line of its comment.

    A name is such as "thesis/figure_3_5.as_reported".
    """
    return {
        f"{folder.parent.name}/{name}": description
        for folder in sorted(studies_dir().glob(f"*/{_FOLDER}"))
        for name, description in described_files(folder).items()
    }


def find_shipped(run: Run) -> Bands:
    """Return the bundled baseline for the experiment and preset that a run was composed from.

    Raises:
        RunnerError: if there is none; the message names the command that lists them.
        StoreError: if it cannot be read, or is not one of runs.
    """
    choices = run.provenance.get("choices", {})
    name = f"{choices.get('experiment')}.{choices.get('preset')}"
    known = shipped_baselines()
    if name not in known:
        what = f"'{name}'{nearest(name, known)}" if choices.get("experiment") else "a run without an experiment"
        raise RunnerError(
            f"{run.folder}: no bundled baseline for {what}. Give one by --baseline FILE; --save-baseline FILE writes "
            f"that of a sweep. `runner list baselines` prints the {len(known)} bundled ones."
        )
    bands = load_baseline(baseline_path(name), name)
    if not isinstance(bands, Bands):
        raise StoreError(f"{name} holds cells of a sweep; a bundled baseline holds bands")
    return bands


def baseline_path(name: str) -> Path:
    """Return the file of a bundled baseline, such as "thesis/figure_3_5.full_equations", existing or not."""
    study, _, file = name.partition("/")
    return studies_dir() / study / _FOLDER / f"{file}.yaml"
