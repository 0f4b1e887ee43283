"""Report on a stored run: config, changed keys, results and provenance."""

import json
import re
from collections.abc import Sequence
from typing import Any

import numpy as np
import yaml

from runner.base.dotted_keys import dotted, leaves
from runner.base.errors import RunnerError
from runner.base.machine import read_machine
from runner.base.quantities import above_rounding, number, quantity, with_powers
from runner.caveats.rounding_growth import SENSITIVE, STEP
from runner.reporting.document import Code, Cover, Document, Notice, Provenance, ReportBlock, Section, Table, Text
from runner.reporting.figures import before_failure, cover, desired_motion, playback, torque_and_error
from runner.reporting.markup import literal
from runner.reporting.metric_titles import capital, key_metrics, title
from runner.reporting.nearest_limit import nearest_to_limit
from runner.reporting.plant_step import describe_plant, percent
from runner.reporting.sections import RunSubject, added_sections, make_sections
from runner.reporting.spec_blocks import spec_abstract, spec_blocks
from runner.reporting.sweep.stability import UNSTABLE
from runner.reporting.table import Column, numbers
from runner.reporting.words import PLANT, in_words, join_values
from runner.store import Run
from runner.store.baselines import check_run, find_shipped
from runner.sweeps.changes import Changes, changed_rules

_KEY_METRICS = 4
_AT_REST = 4.0  # times the settling time, after which an arm is taken to rest
_KEY_AND_VALUE = (Column("key", "code"), Column("value", "code"))
_LEVELS = {"0.01": "1 %", "0.99": "99 %"}  # quantiles that a table has room for


def run_document(run: Run) -> Document:
    """Return the report on a stored run: its name, the moving arm and four numbers first."""
    subject = RunSubject(run)
    own = make_sections(SECTIONS, subject)
    return Document(
        title=run_name(run),
        subtitle=_subtitle(run, subject.changed),
        abstract=literal(_abstract(run)),
        sections=[own[0], *added_sections("run", subject), *own[1:]],
        date=str(run.provenance["date"]),
        cover=_cover(run) if (~np.isnan(run.joints("q"))).all(axis=1).sum() > 1 else None,
        notes=[literal(f"Caveats: {', '.join(_spaced(caveat['rule']) for caveat in run.caveats)}.")]
        if run.caveats
        else [],
        key_numbers=[*key_metrics(run, _KEY_METRICS), *filter(None, [nearest_to_limit(run)])],
    )


def _results(subject: RunSubject) -> Section:
    return Section("The run", run_blocks(subject.run))


def _config(subject: RunSubject) -> Section:
    return Section("Config", config_blocks(subject.run, subject.changed))


def _provenance(subject: RunSubject) -> Section:
    return Section("Provenance", (provenance([subject.run]),))


SECTIONS = (_results, _config, _provenance)
"""Sections: functions of the subject that return a section or None; plug-ins add theirs behind the first."""


def run_name(run: Run) -> str:
    """Return the names of robot, law, task and plant, such as "Macro, operational space, quintic, PyBullet"."""
    config = run.config
    kinds = (config["controller"]["kind"], config["trajectory"]["kind"], config["plant"]["kind"])
    return ", ".join([capital(_spaced(config["robot"]["name"])), *(_spaced(in_words(str(kind))) for kind in kinds)])


def _spaced(name: object) -> str:
    return str(name).replace("_", " ")


def _abstract(run: Run) -> str:
    """Return the end of the run, the number of kept bounds of its spec, and the comparison with its baseline."""
    count = run.record["repetitions"]
    if run.status == "failed":
        ended = with_powers(f"The run {run.failure}.") + "".join(f" {text}" for text in _remedies(run))
    else:
        ended = (
            "One repetition, which finished."
            if count == 1
            else f"{count} repetitions, all of them finished; smallest to largest in brackets."
        )
    if run.spec is not None:
        ended += f" {spec_abstract(run.spec)}"
    try:
        baseline = find_shipped(run)
    except RunnerError:
        return ended
    found = check_run(run, baseline)
    wrong = [title(finding.metric) for finding in found if not finding.good]
    where = f"; outside are: {', '.join(wrong)}" if wrong else ""
    return f"{ended} {len(found) - len(wrong)} of {len(found)} metrics lie in the bands of {baseline.name}{where}."


def _remedies(run: Run) -> list[str]:
    """Return why a run diverges, with the bounds of its keys, if the law's own bound is known."""
    found = [float(one["value"]) for one in run.caveats if one["rule"] == UNSTABLE]
    controller = run.config["controller"]
    given = [(key, controller.get(key)) for key in ("natural_frequency", "period")]
    bounds = [
        f"controller.{key} below {number(value / ratio, plain=1e-4)}"
        for ratio in found
        for key, value in given
        if isinstance(value, int | float)
    ]
    if not bounds:
        return []
    return [f"Its velocity loop is unstable: the gain is {number(found[0], 2)} times too large for the period. Stable, "
            f"if no torque is at its limit: {' or '.join(bounds)}."]  # fmt: skip


def _cover(run: Run) -> Cover:
    """Return the arm in motion; a move that settles early is shown until it rests."""
    settled = run.metrics["settling_time"].median if "settling_time" in run.metrics else None
    until = _AT_REST * settled if settled and run.config["trajectory"]["kind"] == "goal" else None
    if until is None or until >= run.t[-1]:
        return cover(run, "The motion of repetition 0.")
    return cover(run, f"The first {quantity(until, 's')} of repetition 0.", until)


def _subtitle(run: Run, changed: Changes | None) -> str:
    """Return limits and disturbances of the arm, with the keys changed there, and the experiment that was asked for.

    The option "none" of a group is not named with a changed key, which it no longer describes.
    """
    chosen = run.provenance["choices"]
    own = {key: value for key, (_, value) in (changed or {}).items() if key.startswith(("torque_limits.", "noise."))}
    bare = [group for group in chosen if chosen[group] == "none" and any(key.startswith(f"{group}.") for key in own)]
    has_limits = run.config["torque_limits"]["max"] is not None
    named = [group for group in ("torque_limits", "noise") if group in chosen and group not in bare]
    texts = [] if has_limits else ["no torque limits"]
    texts += [f"{_spaced(group)} {_spaced(chosen[group])}" for group in named if group == "noise" or has_limits]
    texts += [f"{key}={_yaml(value)}" for key, value in own.items()]
    texts += [f"input shaper {run.config['input_shaper']['kind'].upper()}"] if "input_shaper" in run.config else []
    texts += ["a notch in the torques"] if "notch" in run.config else []
    texts += [f"experiment {chosen['experiment']}"] if "experiment" in chosen else []
    return ", ".join(texts)


def run_blocks(run: Run) -> list[ReportBlock]:
    """Return failure, caveats, curves, motion and metrics of a run."""
    config = run.config
    blocks: list[ReportBlock] = []
    if (failure := run.failure_record) is not None:
        joint = f", joint {failure['joint']}" if failure["joint"] else ""
        blocks.append(
            Notice(
                "failure",
                "This run failed",
                f"In repetition {failure['repetition']} at t = {number(failure['time'])} s{joint}: "
                f"{with_powers(str(failure['reason']))}. The curves end there.",
            )
        )
    blocks += caveat_notices(run)
    if failure is not None and failure["repetition"] == 0 and failure["time"]:
        blocks += before_failure(run, float(failure["time"]))
    else:
        blocks.append(torque_and_error(run, "Torque of each joint and tip position error, repetition 0."))
    if config["trajectory"]["kind"] != "goal" and failure is None:
        blocks.append(desired_motion(run, "Desired motion of the tip."))
    blocks.append(playback(run, "The motion of repetition 0."))
    blocks += spec_blocks(run)
    if run.metrics:
        blocks.append(_metrics(run))
    return [*blocks, Text(" ".join(filter(None, [describe_plant(run), _describe_rounding(run)])))]


def _describe_rounding(run: Run) -> str:
    """Return the number of metrics that are sensitive to rounding, as a sentence; empty if it is not known."""
    changes = (run.rounding or {}).get("metrics", {}).values()
    if not changes:
        return ""
    count = sum(change > SENSITIVE for change in changes)
    start = f"From a start moved by {number(STEP, 2)} rad or m, repetition 0 gives"
    return f"{start} {f'other values of {count} of {len(changes)} metrics' if count else 'the same metrics'}."


def caveat_notices(run: Run) -> list[ReportBlock]:
    """Return a notice for each reason why a run's result may not be what it seems, and of how these were looked for."""
    notices: list[ReportBlock] = [
        Notice("warning", f"Caveat: {caveat['rule']}", literal(f"{capital(str(caveat['text']))}."))
        for caveat in run.caveats
    ]
    changes = changed_rules(run)
    if changes:
        text = f"This run's caveats were looked for by {'; '.join(changes)}. The same command would not look again."
        notices.append(Notice("warning", "Caveats by other rules than today's", literal(text)))
    return notices


def _metrics(run: Run) -> Table:
    many = all(metric.quantiles for metric in run.metrics.values())
    levels, worth = _LEVELS if many else {}, (run.plant_error or {}).get("metrics", {})
    changes = {name: one for name, one in (run.rounding or {}).get("metrics", {}).items() if one > SENSITIVE}
    rows = []
    for name, m in run.metrics.items():
        found = [m.median, m.min, *(m.quantiles[level] for level in levels), m.max]
        share = worth.get(name, {}).get("share")
        step = ["not comparable" if share is None else percent(share)] if worth else []
        rounded = [percent(changes[name]) if name in changes else "–"] if changes else []
        rows.append([title(name), name, *(above_rounding(value, m.unit) for value in found), *step, *rounded])
    count = run.record["repetitions"]
    told = "; levels are quantiles, a repetition without a value counting as beyond every number" if many else ""
    of_step, of_rounding = ["the plant's step"] if worth else [], ["rounding"] if changes else []
    names = numbers("median", "smallest", *levels.values(), "largest", *of_step, *of_rounding)
    return Table(
        "Metrics of one repetition." if count == 1 else f"Metrics over {count} repetitions{told}.",
        ["metric", Column("name on the command line", "code"), *names],
        rows,
    )


def config_blocks(run: Run, changed: Changes | None) -> list[ReportBlock]:
    """Return the keys that were changed, and then all of them; only all keys for a config that no group here makes."""
    resolved = {key: value for key, value in run.config.items() if key != "outputs"}
    rows = [[dotted(place), _yaml(value)] for place, value in leaves(resolved, lists=False)]
    file = Code(yaml.safe_dump(resolved, sort_keys=False, allow_unicode=True), "config.yaml")
    everything: list[ReportBlock] = [
        Table("All keys and their values.", [*_KEY_AND_VALUE], rows, folded=changed is not None),
        file,
    ]
    if changed is None:
        return everything
    own = [[key, _yaml(value), _yaml(before)] for key, (before, value) in changed.items()]
    if not own:
        return [Text("Every key has the value that its group gives it."), *everything]
    header = [*_KEY_AND_VALUE, Column("in its group", "code")]
    return [Table("Keys that were changed against the groups chosen.", header, own), *everything]


def provenance(runs: Sequence[Run]) -> Provenance:
    """Return the provenance of some runs: plants, versions, machine, commits, dates; values that differ are listed."""
    record = [run.provenance for run in runs]

    def join(values: Sequence[Any]) -> str:
        return join_values(list(dict.fromkeys(str(value) for value in values)))

    versions = (f"{name} {join([r['versions'][name] for r in record])}" for name in record[0]["versions"])
    rows = [
        ("plant", _plants(runs)),
        ("commit", join([r["commit"] or "none (installed package)" for r in record])),
        ("seed", _seeds({int(r["seed"]) for r in record})),
        ("machine", join([read_machine(r["machine"]).text for r in record])),
        ("software", ", ".join(versions)),
        ("made on", join(sorted(str(r["date"]) for r in record))),
    ]
    if len(runs) == 1:
        rows += [("command", str(record[0]["command"])), ("run", runs[0].hash)]
    return Provenance(rows)


def _plants(runs: Sequence[Run]) -> str:
    """Return each plant once with its steps, such as "PyBullet in steps of 0.5 ms, 1 ms; MuJoCo in steps of 1 ms"."""
    steps: dict[str, set[float]] = {}
    for run in runs:
        steps.setdefault(str(run.config["plant"]["kind"]), set()).add(float(run.provenance["plant_step"]))
    return "; ".join(
        f"{PLANT.get(kind, kind)} in steps of {', '.join(quantity(step, 's') for step in sorted(own))}"
        for kind, own in steps.items()
    )


def _seeds(seeds: set[int]) -> str:
    """Return some seeds, those that follow each other as a range, such as "0 to 99, 200"."""
    told: list[list[int]] = []
    for seed in sorted(seeds):
        if told and seed == told[-1][-1] + 1:
            told[-1].append(seed)
        else:
            told.append([seed])
    return ", ".join(str(own[0]) if len(own) == 1 else f"{own[0]} to {own[-1]}" for own in told)


def _yaml(value: Any) -> str:
    """Return a value as given in YAML or on the command line."""
    text = value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
    return re.sub(r"\b(\d)0{6,}\.0\b", lambda found: f"{float(found[0]):.0e}".replace("e+0", "e"), text)
