"""Baselines: bands at both ends, missing values and bad files; the shipped ones are valid."""

import math

import numpy as np
import pytest
from pydantic import ValidationError

from runner.base.errors import RunnerError, StoreError
from runner.config.compose.files import group_options
from runner.papers.reporting.published_claims import load_claims
from runner.plugins.metric_units import unit_of
from runner.store import Run
from runner.store.baselines import Band, Bands, baseline_path, check_run, load_baseline, renew_bands, shipped_baselines


@pytest.fixture
def load(tmp_path):
    def write_and_load(text):
        path = tmp_path / "baseline.yaml"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return load_baseline(path)

    return write_and_load


def stored(tmp_path, status="ok", **medians):
    metrics = {name: {"unit": "1", "median": median, "min": median, "max": median} for name, median in medians.items()}
    return Run(
        tmp_path, {}, {"status": status, "repetitions": 1, "metrics": metrics, "failure": None, "provenance": {}}
    )


def problems(load, text):
    with pytest.raises(StoreError) as raised:
        load(text)
    return [line.removeprefix("  - ") for line in str(raised.value).splitlines()[1:]]


def test_a_valid_reference_is_read(load):
    reference = load(
        "schema: 1\nmetrics:\n  energy: {min: 1e-3, max: 2, reason: r}\n  peak_torque_q1: {max: 5, reason: r}"
    )
    assert reference.bands["energy"] == Band(min=1e-3, max=2.0, reason="r")
    assert reference.bands["peak_torque_q1"].min is None
    assert reference.name.endswith("baseline.yaml")


@pytest.mark.parametrize(
    ("ends", "inside", "outside"),
    [
        ({"min": 1.0, "max": 2.0}, [1.0, 1.5, 2.0], [math.nextafter(1.0, 0.0), math.nextafter(2.0, 3.0)]),
        ({"min": 1.0}, [1.0, 1e300], [0.0]),
        ({"max": 1.0}, [-1e300, 1.0], [1.1]),
        ({"min": 0.0, "max": 0.0}, [0.0, -0.0], [1e-300]),
    ],
)
def test_both_ends_belong_to_a_band(ends, inside, outside):
    band = Band(**ends, reason="r")
    assert all(band.range.holds(value) for value in inside)
    assert not any(band.range.holds(value) for value in outside)


def test_nan_lies_in_no_band():
    assert not Band(min=0.0, reason="r").range.holds(math.nan)


def test_a_band_cannot_be_changed():
    with pytest.raises(ValidationError):
        Band(max=1.0, reason="r").max = 2.0


def test_all_problems_are_said_at_once(load):
    found = problems(
        load,
        """\
schema: 2
metric: {}
metrics:
  setling_time: {max: 1.0, reason: r}
  energy: {min: 2.0, max: 1.0, reason: r}
  overshoot: {reason: r}
  peak_torque: {max: 1.0}
  rms_torque: {mx: 1.0, reason: ""}
  control_effort: {max: .inf, min: much, reason: r}
  saturation_fraction: 3
""",
    )
    starts = [
        "schema: must be 1; found 2",
        "metrics.setling_time: unknown metric 'setling_time'. Allowed: settling_time, ",
        "metrics.energy: min 2 is above max 1; found ",
        "metrics.overshoot: needs min, max or both; found ",
        "metrics.peak_torque.reason: missing",
        "metrics.rms_torque.reason: must not be empty; found ''",
        "metrics.rms_torque.mx: unknown key (did you mean max?); keys: min, max, reason",
        "metrics.control_effort.min: must be a number; found 'much'",
        "metrics.control_effort.max: must be a finite number; found inf",
        "metrics.saturation_fraction: must be a group of keys; found 3",
        "metric: unknown key (did you mean metrics?); keys: schema, metrics",
    ]
    assert [text[: len(start)] for text, start in zip(found, starts, strict=True)] == starts


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("schema: 1\n", "metrics: missing"),
        ("schema: 1\nmetrics: {}\n", "metrics: must have at least one metric; found {}"),
    ],
)
def test_a_reference_needs_bands(load, text, message):
    assert problems(load, text) == [message]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("schema: 1\nschema: 1\n", "line 2: the key 'schema' stands twice"),
        ("schema: [\n", "line 2, column 1: "),
        (b"\xff\xfe\x00", "cannot read the baseline "),
        ("3", "cannot read the baseline "),
        ("- 1\n", "it must have schema, and metrics or cells"),
        ("schema: ${nope}\n", "schema: must be 1; found '${nope}'"),
    ],
)
def test_what_is_no_yaml_is_said_with_its_line(load, text, message):
    with pytest.raises(StoreError, match=r"baseline\.yaml") as raised:
        load(text)
    assert message in str(raised.value)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(StoreError, match=r"cannot read the baseline .*gone\.yaml: .*No such file"):
        load_baseline(tmp_path / "gone.yaml")


def test_inside_outside_null_and_absent(tmp_path):
    band = Band(min=1.0, max=2.0, reason="r")
    reference = Bands("mine", dict.fromkeys(("inside", "outside", "null", "absent"), band))
    findings = check_run(stored(tmp_path, inside=1.5, outside=2.5, null=None), reference)
    assert [(finding.value, finding.good) for finding in findings] == [
        (1.5, True),
        (2.5, False),
        (None, False),
        (None, False),
    ]


def test_a_failed_run_has_no_good_metric(tmp_path):
    reference = Bands("mine", {"energy": Band(max=2.0, reason="r")})
    assert not check_run(stored(tmp_path, status="failed", energy=1.0), reference)[0].good


def test_the_shipped_baselines_are_valid():
    wrong = []
    for name in shipped_baselines():
        reference = load_baseline(baseline_path(name), name)
        experiment, _, preset = name.rpartition(".")
        if experiment not in group_options("experiment") or preset not in group_options("preset"):
            wrong.append(name)
        for metric, band in reference.bands.items():
            if not unit_of(metric) or band.min is None or band.max is None:
                wrong.append(f"{name}: {metric}")
    assert shipped_baselines()
    assert wrong == []


def test_every_figure_that_carries_a_claim_has_a_reference():
    experiments = {claim.experiment for claim in load_claims("thesis")}
    assert {f"{name}.{preset}" for name in experiments for preset in ("full_equations", "as_reported")} <= set(
        shipped_baselines()
    )


FILE = """\
# Two bands
# of an arm
schema: 1
metrics:
  energy: {min: 0.0, max: 1.0, reason: 'a sum; over all; 3 seeds gave 1 to 2 J'}
  settling_time: {max: 1.0, reason: a transient, margin: 0.3}
  peak_torque: {min: 0.0, max: 0.0, reason: no torque}
"""


def seeds(tmp_path, changes=({}, {}), failed=False, **metrics):
    """Return runs with seeds 0, 1, ..., from the values of each metric in each run."""
    runs = []
    for seed, change in enumerate(changes):
        own = {name: values[seed] for name, values in metrics.items()}
        record = {
            "repetitions": 4, "status": "failed" if failed else "ok", "provenance": {},
            "failure": {"repetition": 0, "time": 0.1, "joint": "q1", "reason": "diverged"} if failed else None,
            "metrics": {name: {"unit": unit_of(name), "median": None if np.isnan(each).all() else np.median(each),
                               "min": min(each), "max": max(each), "values": each} for name, each in own.items()},
        }  # fmt: skip
        runs.append(Run(tmp_path, {"seed": seed, "controller": {"kind": "pd", "period": 0.01}} | change, record))
    return runs


VALUES = {
    "energy": ([10.0, 11.0, 13.0, 14.0], [12.0, 12.0, 20.0, 20.0]),
    "settling_time": ([1.0] * 4, [1.1] * 4),
    "peak_torque": ([0.0] * 4, [0.0] * 4),
}


def renew(tmp_path, runs, text=FILE):
    path = tmp_path / "bands.yaml"
    path.write_text(text)
    return path, renew_bands(load_baseline(path), runs, path)


def test_bands_are_the_medians_of_the_seeds_with_half_the_quartiles_or_the_margin(tmp_path):
    path, count = renew(tmp_path, seeds(tmp_path, **VALUES))
    bands = load_baseline(path).bands
    assert count == 3
    # Quartiles of all repetitions of energy are 11.75 and 15.5: 12 and 16, less and plus 1.875 and 2 % of 16.
    assert (bands["energy"].min, bands["energy"].max) == (9.8, 18.2)
    assert bands["energy"].reason == "a sum; over all; 2 seeds gave 12 to 16 J"
    assert (bands["settling_time"].min, bands["settling_time"].max, bands["settling_time"].margin) == (None, 1.4, 0.3)
    assert (bands["peak_torque"].min, bands["peak_torque"].max) == (0.0, 0.0)
    text = path.read_text()
    assert text.startswith("# Two bands\n# of an arm\nschema: 1\n")
    assert renew(tmp_path, seeds(tmp_path, **VALUES), text)[0].read_text() == text


@pytest.mark.parametrize(
    ("changes", "options", "problem"),
    [
        ([{}], {}, "two or more seeds"),
        ([{}, {"seed": 0}], {}, "two or more seeds"),
        ([{}, {"controller": {"kind": "pd", "period": 0.02}, "plant": 1}], {}, "not in controller.period, plant."),
        ([{}, {}], {"failed": True}, "cannot be in a baseline:\n  - .* at t = 0.1 s"),
        ([{}, {}], {"energy": ([1.0] * 4, [math.nan] * 4)}, "no median of energy. Remove"),
    ],
)
def test_bands_need_good_runs_that_differ_in_the_seed_only(tmp_path, changes, options, problem):
    with pytest.raises(StoreError, match=problem):
        renew(tmp_path, seeds(tmp_path, changes, **VALUES | options))
    assert (tmp_path / "bands.yaml").read_text() == FILE


def test_a_band_of_a_metric_that_the_runs_lack_is_rejected(tmp_path):
    with pytest.raises(RunnerError, match="no metric 'peak_torque'"):
        renew(tmp_path, seeds(tmp_path, **{name: VALUES[name] for name in ("energy", "settling_time")}))
