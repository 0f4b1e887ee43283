"""Records of many runs as strings, against the records of single runs."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

from runner.caveats.rule import Caveat, Found
from runner.metrics.summary import summarize_arrays
from runner.plugins.metric_units import unit_of
from runner.store import Finished, RunOutcome
from runner.store.run import Run
from runner.store.seal import JsonTexts
from runner.store.shards import METRIC, ShardRow, read_columns, read_outcomes, shard_name, write_shard
from runner.sweeps.records import make_record, record_texts

NAMES = ("settling_time", "peak_torque_q1", "macro_overshoot", "energy", "saturation_fraction")
TIMING = {"tick_time_median": None, "tick_time_p99": 1e-6, "wall_s": 0.25, "cpu_s": 0.5}
SHARED = {"versions": {"python": "3.11"}, "machine": "Prüfstand", "commit": None, "warnings": [], "plant_step": 0.01}
THRESHOLDS = {"chatter": {"share": 0.05}}


def some_runs(runs, repetitions):
    draw = np.random.default_rng(runs)
    metrics = {name: 10.0 ** draw.uniform(-9.0, 9.0, (runs, repetitions)) for name in NAMES}
    metrics["settling_time"][draw.random((runs, repetitions)) < 0.4] = np.nan
    metrics["saturation_fraction"][:] = 0.0
    caveats = [Caveat("chatter", 'it "chatters"', 0.5 + run) for run in range(runs)]
    found = [Found(caveats[: run % 3], "abc", THRESHOLDS) for run in range(runs)]
    provenances = [
        {"date": "2026-01-01", "command": f"runner seed={run}", "seed": run, **SHARED} for run in range(runs)
    ]
    return metrics, found, provenances


def record_alone(metrics, run, found, provenance):
    repetitions = len(next(iter(metrics.values()))[run])
    each = summarize_arrays(tuple(metrics), np.array([values[run] for values in metrics.values()]).T)
    result = SimpleNamespace(
        failure=None, caveats=found, metrics=each, timing=TIMING, provenance=provenance, plant_error=None,
        rounding=None,
        config=SimpleNamespace(settings=SimpleNamespace(repetitions=repetitions), resolved={}),
    )  # fmt: skip
    return make_record(result)


@pytest.mark.parametrize("repetitions", [1, 2, 5])
def test_the_records_of_many_runs_are_those_of_each_alone(repetitions):
    metrics, found, provenances = some_runs(7, repetitions)
    texts = record_texts(repetitions, found, TIMING, provenances, JsonTexts())
    for run, text in enumerate(texts):
        alone = record_alone(metrics, run, found[run], provenances[run])
        del alone["metrics"]
        assert text == json.dumps(alone)


@pytest.mark.parametrize("repetitions", [1, 2, 5])
def test_rows_of_texts_stand_in_a_shard_beside_runs(tmp_path, repetitions):
    metrics, found, provenances = some_runs(4, repetitions)
    texts, config = JsonTexts(), {"seed": 3, "noise": {"position": 1e-4}}
    records = record_texts(repetitions, found, TIMING, provenances, texts)
    names = [f"a{run}" for run in range(4)]
    of_metrics = tuple((metric, unit_of(metric)) for metric in metrics)
    rows = [
        ShardRow(
            RunOutcome(name, "", False, len(found[run].caveats)),
            texts.of(config),
            "<robot/>",
            records[run],
            of_metrics,
            np.stack([values[run] for values in metrics.values()], axis=1),
        )
        for run, name in enumerate(names)
    ]
    alone = record_alone(metrics, 3, found[3], provenances[3])
    path = write_shard(
        tmp_path, shard_name(1, "a", 1), [*rows[:3], Run(tmp_path / "runs" / "a3", config, alone, "<robot/>")]
    )
    assert list(read_outcomes(path)) == [row.outcome for row in rows]
    columns = read_columns(path, ["run"], METRIC)
    for metric, values in metrics.items():
        expected = [[None if np.isnan(value) else value for value in own] for own in values]
        assert columns[f"metric {metric}"].to_pylist() == expected
    for place, name in enumerate(names):
        run = Finished(tmp_path).open(name)
        whole = json.loads(json.dumps(record_alone(metrics, place, found[place], provenances[place])))
        assert (run.record, run.config, run.urdf) == (whole, config, "<robot/>")
        assert list(run.metrics) == list(metrics)


def test_what_configs_have_in_common_is_written_as_if_each_were_alone():
    shared = {"k": [1, 2.5, None, True, "é\n"], "inner": {"a": {}}}
    texts, start = JsonTexts(), {"seed": 0, "shared": shared, "list": [1.0], "none": None, "inf": float("inf")}
    for seed in range(3):
        config = {**start, "seed": seed, "own": {"gain": 10.0**-seed}, "list": [float(seed)]}
        assert texts.of(config) == json.dumps(config)
    assert texts.of({}) == "{}"
