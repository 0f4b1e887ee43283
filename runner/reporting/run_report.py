"""A report on any stored runs: what was run, what came out, and where it comes from."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

from runner.caveats import changes_since
from runner.quantities import above_rounding, number, with_powers
from runner.reporting.document import Block, Document, Notice, Provenance, Section, Table, Text
from runner.reporting.figures import desired_motion, playback, torque_and_error
from runner.reporting.markup import literal, literals
from runner.reporting.metric_titles import title
from runner.reporting.plant_agreement import describe_agreement
from runner.store import Run

_HEADLINE = ("settling_time", "steady_state_error", "max_tracking_error", "peak_torque", "saturation_fraction")


def run_document(runs: Sequence[Run]) -> Document:
    """Return the report on some stored runs."""
    failed = [run for run in runs if run.status == "failed"]
    count = "1 run" if len(runs) == 1 else f"{len(runs)} runs"
    abstract = f"{count}, {len(failed)} of them failed." if failed else f"{count}, all of them finished."
    overview = [Section("Overview", (_overview(runs),))] if len(runs) > 1 else []
    return Document(
        title="Robot-arm control runs",
        subtitle=", ".join(dict.fromkeys(str(run.config["robot"]["name"]) for run in runs)),
        abstract=abstract,
        sections=[*overview, *(_section(run, index) for index, run in enumerate(runs, start=1))],
        date=max(str(run.provenance["date"]) for run in runs),
    )


def _overview(runs: Sequence[Run]) -> Table:
    names = [name for name in _HEADLINE if any(name in run.metrics for run in runs)]
    varying = _varying(runs)
    rows = []
    for index, run in enumerate(runs, start=1):
        config = _flatten(run.config)
        values = [
            above_rounding(run.metrics[name]["median"], run.metrics[name]["unit"]) if name in run.metrics else "–"
            for name in names
        ]
        keys = (literal(str(config.get(key, "–"))) for key in varying)
        rows.append([str(index), *keys, run.status, str(len(run.caveats)), *values])
    header = ["run", *varying, "status", "caveats", *(literal(title(name)) for name in names)]
    first = len(varying) + 2
    return Table("Runs, with what distinguishes them; medians.", header, rows, tuple(range(first, len(header))))


def _section(run: Run, index: int) -> Section:
    config = run.config
    title = f"Run {index}: {config['robot']['name']}, {config['controller']['kind']}, {config['trajectory']['kind']}"
    blocks: list[Block] = []
    if run.failure is not None:
        joint = f", joint {run.failure['joint']}" if run.failure["joint"] else ""
        blocks.append(
            Notice(
                "failure",
                "This run failed",
                f"In repetition {run.failure['repetition']} at t = {number(run.failure['time'])} s{joint}: "
                f"{with_powers(str(run.failure['reason']))}. The curves end there.",
            )
        )
    blocks += caveat_notices(run)
    blocks.append(torque_and_error(run, "Torque of each joint and tip position error, repetition 0."))
    if config["trajectory"]["kind"] != "goal":
        blocks.append(desired_motion(run, "Desired motion of the tip."))
    blocks.append(playback(run, "The motion of repetition 0."))
    if run.metrics:
        blocks.append(_metrics(run))
    blocks += [Text(describe_agreement(run)), _config(run), provenance([run])]
    return Section(title, blocks)


def caveat_notices(run: Run) -> list[Block]:
    """Return a notice for each reason why a run's result may not be what it seems, and of how these were looked for."""
    notices: list[Block] = [
        Notice("warning", f"Caveat: {caveat['rule']}", literal(f"{_sentence(str(caveat['text']))}."))
        for caveat in run.caveats
    ]
    changes = changes_since(run.caveat_rules)
    if changes:
        text = f"This run's caveats were looked for by {'; '.join(changes)}. The same command would not look again."
        notices.append(Notice("warning", "Caveats by other rules than today's", literal(text)))
    return notices


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:]


def _metrics(run: Run) -> Table:
    rows = [
        [title(name), name, *(above_rounding(m[which], m["unit"]) for which in ("median", "min", "max"))]
        for name, m in run.metrics.items()
    ]
    count = run.record["repetitions"]
    return Table(
        "Metrics of one repetition." if count == 1 else f"Metrics over {count} repetitions.",
        ["metric", "name on the command line", "median", "smallest", "largest"],
        [literals(row) for row in rows],
        (2, 3, 4),
        code=(1,),
    )


def _config(run: Run) -> Table:
    rows = [literals([key, _yaml(value)]) for key, value in _flatten(run.config).items() if key != "outputs"]
    return Table("Config, all values.", ["key", "value"], rows, code=(0, 1))


def provenance(runs: Sequence[Run]) -> Provenance:
    """Return what made some runs: plants, versions, machine, commits, dates; values that differ are listed."""
    record = [run.provenance for run in runs]

    def join(values: Sequence[Any]) -> str:
        return ", ".join(dict.fromkeys(str(value) for value in values))

    versions = {name: join([r["versions"][name] for r in record]) for name in record[0]["versions"]}
    rows = [
        ("plant", join([f"{run.config['plant']['kind']}, step {run.provenance['plant_step']:g} s" for run in runs])),
        ("commit", join([r["commit"] or "none (installed package)" for r in record])),
        ("seed", join([r["seed"] for r in record])),
        ("machine", join([r["machine"] for r in record])),
        *versions.items(),
        ("made on", join(sorted(str(r["date"]) for r in record))),
    ]
    unsealed = sum(not run.sealed for run in runs)
    if unsealed:
        rows.append(("unsealed", f"{unsealed} of {len(runs)} runs have no digests: damage to them is not found"))
    if len(runs) == 1:
        rows += [("command", str(record[0]["command"])), ("run", runs[0].hash)]
    return Provenance(rows)


def _varying(runs: Sequence[Run]) -> list[str]:
    flat = [_flatten(run.config) for run in runs]
    keys = dict.fromkeys(
        key for config in flat for key in config if key != "outputs" and not key.startswith("caveats.")
    )
    return [
        key
        for key in keys
        if key == "robot.name" or (not key.startswith("robot.") and len({str(config.get(key)) for config in flat}) > 1)
    ]


def _flatten(value: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for key, item in value.items():
        if isinstance(item, Mapping) and item:
            flat |= _flatten(item, f"{prefix}{key}.")
        else:
            flat[f"{prefix}{key}"] = item
    return flat


def _yaml(value: Any) -> str:
    """Return a value as it is given in YAML or on the command line."""
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
