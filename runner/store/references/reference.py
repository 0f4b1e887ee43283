"""Baseline of a run: a tolerance band for each metric, with the reason for its width."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import yaml
from omegaconf import OmegaConf
from omegaconf.errors import OmegaConfBaseException
from pydantic import Field, ValidationError

from runner.base.errors import RunnerError, StoreError, nearest
from runner.base.limits import read_text
from runner.base.paths import studies_dir
from runner.config.compose.messages import describe
from runner.config.compose.options import described_files
from runner.config.spec import Bound
from runner.plugins.metric_units import unit_of, units

if TYPE_CHECKING:
    from runner.store import Run


SCHEMA = 1


class Band(Bound):
    """Where a metric's median has to lie, ends included.

    Attributes:
        reason: Why the band is where it is and as wide as it is.
    """

    reason: Annotated[str, Field(min_length=1)]


@dataclass(frozen=True)
class Reference:
    """A checked baseline.

    Attributes:
        name: Its name or path, for messages.
        bands: Band of each metric by name.
    """

    name: str
    bands: Mapping[str, Band]


@dataclass(frozen=True)
class Finding:
    """How one metric of a run compares with its band.

    Attributes:
        metric: Name of the metric.
        value: Its median over the repetitions; None where the run has none.
        band: Its band.
        good: Whether the run is a good one and the value lies in the band.
    """

    metric: str
    value: float | None
    band: Band
    good: bool


def load_reference(path: Path, name: str | None = None) -> Reference:
    """Read a baseline, `{schema: 1, metrics: {NAME: {min:, max:, reason:}}}`.

    Args:
        path: The file.
        name: What messages call it; None is its path.

    Raises:
        StoreError: if it cannot be read or is not a baseline; lists all its problems.
    """
    # Read as the configs are: 1e-3 is a number, a key given twice an error.
    from runner.base.bounded_yaml import STORED, YamlError, check_yaml, explain_yaml

    try:
        check_yaml(read_text(path, STORED.size), path, STORED)
        content = OmegaConf.to_container(OmegaConf.load(path), resolve=False)
    except YamlError as error:
        raise StoreError(f"baseline {error}") from error
    except yaml.YAMLError as error:
        raise StoreError(f"baseline {explain_yaml(error, path)}") from error
    except (OSError, ValueError, OmegaConfBaseException) as error:
        raise StoreError(f"cannot read the baseline {path}: {error}") from error
    bands: dict[str, Band] = {}
    problems = list(_check_content(content, bands))
    if problems:
        raise StoreError("\n".join([f"{path} is not a valid baseline:", *(f"  - {problem}" for problem in problems)]))
    return Reference(name or str(path), bands)


def check_run(run: "Run", reference: Reference) -> list[Finding]:
    """Compare the medians of a run with a baseline; every metric of a failed run falls short."""
    findings = []
    for metric, band in reference.bands.items():
        value = run.metrics.get(metric, {}).get("median")
        good = run.status == "ok" and value is not None and band.holds(value)
        findings.append(Finding(metric, value, band, good))
    return findings


def _check_content(content: Any, bands: dict[str, Band]) -> Iterator[str]:
    """Yield the problems of a baseline's content; put its bands into `bands`."""
    if not isinstance(content, dict):
        yield "must hold schema and metrics"
        return
    keys = ("schema", "metrics")
    for key in content:
        if key not in keys:
            yield f"{key}: unknown key{nearest(str(key), keys)}; keys: {', '.join(keys)}"
    if content.get("schema") != SCHEMA:
        yield f"schema: must be {SCHEMA}; found {content.get('schema')!r}"
    metrics = content.get("metrics")
    if not isinstance(metrics, dict) or not metrics:
        yield f"metrics: must name a band for at least one metric; found {metrics!r}"
        return
    known = units()
    for name, band in metrics.items():
        if unit_of(str(name)) is None:
            yield f"metrics.{name}: unknown metric{nearest(str(name), known)}; metrics: {', '.join(known)}"
        try:
            bands[name] = Band.model_validate(band)
        except ValidationError as error:
            yield from describe(f"metrics.{name}", Band, error)


_FOLDER = "references"


def shipped_references() -> list[str]:
    """Return their names, such as "thesis/figure_3_5.as_reported", sorted."""
    return list(described_references())


def described_references() -> dict[str, str]:
    """Return their names, sorted, each with the first line of its comment."""
    return {
        f"{folder.parent.name}/{name}": description
        for folder in sorted(studies_dir().glob(f"*/{_FOLDER}"))
        for name, description in described_files(folder).items()
    }


def find_shipped(run: "Run") -> Reference:
    """Return the baseline for the experiment and preset that a run was composed from.

    Raises:
        RunnerError: if there is none; says where those there are stand.
    """
    choices = run.provenance.get("choices", {})
    name = f"{choices.get('experiment')}.{choices.get('preset')}"
    known = shipped_references()
    if name not in known:
        what = f"'{name}'{nearest(name, known)}" if choices.get("experiment") else "a run without an experiment"
        raise RunnerError(
            f"{run.folder}: no baseline comes with the runner for {what}; give one by --baseline FILE, which "
            f"--save-baseline FILE makes of a sweep; `runner list baselines` prints the {len(known)} that come with it"
        )
    return load_reference(reference_path(name), name)


def reference_path(name: str) -> Path:
    """Return the file of a baseline, such as "thesis/figure_3_5.full_equations", whether it is there or not."""
    study, _, file = name.partition("/")
    return studies_dir() / study / _FOLDER / f"{file}.yaml"
