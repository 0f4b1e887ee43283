"""Records of runs, and the writer of a run: its config, its first trace and, last, its metrics.

A run with metrics is complete.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import yaml

from runner.caveats.rule import Found
from runner.simulation.results import RunResult
from runner.statistics.spec import bounds_of, judge
from runner.store.drawn import draws_nothing
from runner.store.parquet import OF_NUMBERS, VALUES_FILE, encode_parquet, trace_table, values_parquet
from runner.store.run import Run
from runner.store.seal import JsonTexts, encode_finite, write_job


def write_run(outputs: Path, name: str, result: RunResult) -> Run:
    """Store a run in its own folder.

    Raises:
        StoreError: if a file cannot be written.
    """
    folder = outputs / "runs" / name
    config = yaml.dump(dict(result.config.resolved), sort_keys=False, Dumper=yaml.CSafeDumper)
    files = {
        "trace.parquet": encode_parquet(trace_table(result.trace), **OF_NUMBERS),
        "config.yaml": config.encode(),
        "robot.urdf": result.config.arm.urdf.encode(),
    }
    beside = {metric: summary.values for metric, summary in result.metrics.items() if not summary.listed}
    if beside:
        files[VALUES_FILE] = values_parquet(beside)
    dear = ("trace.parquet", VALUES_FILE)
    record = write_job(folder, "metrics.json", make_record(result), files, flushed=dear)
    return Run(folder, result.config.resolved, record)


def make_record(result: RunResult) -> dict[str, Any]:
    """Return the content of metrics.json, without schema and digests."""
    record: dict[str, Any] = {
        "status": "ok" if result.failure is None else "failed",
        "repetitions": result.config.settings.repetitions,
    }
    if result.failure is not None:
        repetition, failure = result.failure
        record["failure"] = {**asdict(failure), "repetition": repetition}
    record |= result.caveats.record()
    bounds = bounds_of(result.config.resolved)
    if bounds:
        values = {metric: summary.values for metric, summary in result.metrics.items()}
        repetitions, exact = result.config.settings.repetitions, draws_nothing(result.config.resolved)
        record["spec"] = judge(bounds, repetitions, values, values.__getitem__, exact).record()
    record["metrics"] = {metric: summary.record() for metric, summary in result.metrics.items()}
    if result.plant_error is not None:
        record["plant_error"] = result.plant_error.record()
    if result.rounding is not None:
        record["rounding"] = result.rounding.record()
    record["timing"] = dict(result.timing)
    record["provenance"] = dict(result.provenance)
    return record


def record_texts(
    repetitions: int,
    found: Sequence[Found],
    timing: Mapping[str, float | None],
    provenances: Sequence[Mapping[str, Any]],
    texts: JsonTexts,
) -> list[str]:
    """Return the records of good runs as JSON: those of `make_record` without metrics.

    Args:
        repetitions: Number of repetitions of each run.
        found: Caveats of each run.
        timing: Measured times, the same for each run.
        provenances: Provenance of each run.
        texts: Encoder that caches the JSON of common values.
    """
    clocked = encode_finite(timing)
    records = []
    for caveats, provenance in zip(found, provenances, strict=True):
        rules = texts.of({"digest": caveats.digest, "thresholds": caveats.thresholds})
        records.append(
            f'{{"status": "ok", "repetitions": {repetitions}, '
            f'"caveats": {encode_finite([vars(caveat) for caveat in caveats.caveats])}, "caveat_rules": {rules}, '
            f'"timing": {clocked}, "provenance": {texts.of(provenance)}}}'
        )
    return records


def cut_short_record(reason: str, repetitions: int, provenance: Mapping[str, Any]) -> dict[str, Any]:
    """Return the record of an aborted run."""
    failure = {"reason": reason, "time": None, "joint": None, "repetition": None}
    return {
        "status": "failed",
        "repetitions": repetitions,
        "failure": failure,
        "caveats": [],
        "metrics": {},
        "timing": {},
        "provenance": dict(provenance),
    }
