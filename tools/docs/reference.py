"""Writes docs/reference.md, all keys, metrics and commands, from the models; `make record` runs it.

Meaning and unit of a key come from its model's docstring, what is allowed from its type, its default from conf/. So the
page says what the code does; a test fails where it is stale.
"""

import argparse
import inspect
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, get_origin

import yaml

from runner.assembly.run_config import RunSettings
from runner.base.paths import conf_dir
from runner.calibration import CALIBRATIONS
from runner.cli import commands
from runner.cli.parser import COMMON, build_parser
from runner.config.calibration import CalibrationSettings
from runner.config.compose.files import group_options, place_in
from runner.config.groups import GROUPS
from runner.config.json_schema import meanings
from runner.config.judgement import CaveatsConfig
from runner.config.limits import SweepConfig
from runner.config.robot import OneArmConfig, StageConfig
from runner.controllers.joint_space.joint_law import JointLawConfig
from runner.papers.study.chapters import SHARED
from runner.papers.study.code import public_functions
from runner.plugins.metric_units import families
from runner.plugins.registry import Kinds
from runner.schema.bound import Bound
from runner.schema.model import StrictModel, nested_model
from runner.schema.units import WRITTEN
from tools.docs.allowed_values import describe
from tools.docs.compiled_table import compiled_section

PAGE = Path(__file__).resolve().parents[2] / "docs" / "reference.md"
_HEAD = """\
# Reference

All config keys, metrics and commands, from the models by `make record`. The command line has them:

    $ runner --cfg job robot=macro
    $ runner list metrics

Units are SI, angles in rad; prismatic joints use m instead of rad. A default such as `${robot.period}` is the value
of another key. "By stage" means one value for a robot of one arm, and a mapping with one for each stage of several
arms. The magnitude of a number other than 0 is between 1e-12 and 1e12 (a number in a list may be smaller). A name has
at most 200 characters.

## Units

A number may have a unit, in YAML and on the command line: `controller.period=20ms`, `robot.home=[0,-30deg,90deg]`,
`noise.position=0.1deg`, or `controller.period=interval(5ms,50ms)` for `runner tune`. The config and the axes of a
sweep store the number in SI units, so `controller.period=0.02` is the same run. `runner` rejects a unit that does not
fit its key. Quote characters that the shell or Hydra interprets: `"gravity='9.8m/s^2'"`. A key of joints takes angles
for revolute joints and lengths for prismatic ones; one value for both kinds has no unit. A plug-in's key has the unit
of its type, such as `reach: Metres[PositiveFloat]`; `runner.plugin.units` has these types.

| Unit of the key | Accepted units |
|---|---|
"""
_OPTION = {"input_shaper": "zv", "notch": "torques", "preset": "full_equations", "wrist_sensor": "ideal"}
"""Option of a group whose values are the defaults on the page, if it is not "none"."""
_ELSEWHERE = ("robot", "sweep", "limits", "caveats", "spec")
"""Groups with a section of another form."""


def reference_text() -> str:
    """Return the page."""
    sections = [
        _HEAD,
        *_units(),
        "## Keys\n\n",
        *_keys(),
        "## Compiled code\n\n",
        *compiled_section(),
        "## Metrics\n\n",
        *_metrics(),
        "## In chapters\n\n",
        *_chapters(),
        "## Commands\n\n",
        *_commands(),
    ]
    return "".join(sections).rstrip() + "\n"


def _units() -> Iterator[str]:
    for unit, written in WRITTEN.items():
        yield f"| {unit} | {', '.join(f'`{each}`' for each in written)} |\n"
    yield "\n"


def _keys() -> Iterator[str]:
    yield "### At the root\n\n"
    yield _table("", RunSettings, _read("run"))
    yield "For sweeps, `runner -m`:\n\n"
    yield _table("sweep", SweepConfig, _read("run")["sweep"])
    yield "".join(_sweeper())
    yield "For [warnings](caveats.md) that a result may mislead:\n\n"
    yield _table("caveats", CaveatsConfig, _read("caveats")["caveats"])
    yield "For `runner calibrate`:\n\n"
    yield _table("", CalibrationSettings, _read("calibrate"))
    yield "### robot\n\n" + _options("robot")
    defaults = _read("robot_defaults")["robot"]
    one, stage = _rows("robot", OneArmConfig, defaults), _rows("robot", StageConfig, {**defaults, "mount": None})
    yield "A robot of several arms has these keys in `robot.stages.NAME` of each.\n\n"
    yield _merged({"one arm": [*one], "several arms": [*stage]})
    kinds = {group: known for group, known in GROUPS.items() if isinstance(known, Kinds) and len(_built_in(known)) > 1}
    for group, registry in {**kinds, "calibration": CALIBRATIONS}.items():
        yield f"### {group}\n\n" + _options(group)
        rows = {kind: [*_kind_rows(group, kind, registry)] for kind in _built_in(registry)}
        yield "Keys by `kind`:\n\n" + "".join(f"- `{kind}`: {_keys_of(own)}\n" for kind, own in rows.items()) + "\n"
        yield _merged(rows)
        if group == "controller":
            yield "#### controller: one function\n\n"
            yield "A [function](plugins.md#a-law-as-one-function) has the keys of its arguments, and:\n\n"
            yield _table(group, JointLawConfig, _read("function_law"))
    for group, known in GROUPS.items():
        if group in kinds or group in _ELSEWHERE:
            continue
        model = known.config_model(str(known.default)) if isinstance(known, Kinds) else known
        option = _OPTION.get(group, "none")
        yield f"### {group}\n\n{_options(group)}Defaults are those of `{group}={option}`.\n\n"
        yield _table(group, model, _read(f"{group}/{option}"))
    yield "### spec\n\n" + _options("spec")
    yield "[Bounds](how_sure.md) on metrics, by the metric's name.\n\n"
    yield _table("spec.metrics.NAME", Bound, {name: field.default for name, field in Bound.model_fields.items()})


def _built_in(registry: Kinds) -> list[str]:
    return [kind for kind in registry.names() if not registry.is_user_supplied(kind)]


def _sweeper() -> Iterator[str]:
    """Yield the keys of the sweeper, with the comments of its file as meanings."""
    text = (conf_dir() / "hydra" / "sweeper" / "runner.yaml").read_text(encoding="utf-8")
    yield "| Key | Meaning | Default |\n|---|---|---|\n"
    for name, default, meaning in re.findall(r"^([a-z]\w*): +(\S+) +# (.+)$", text, re.M):
        yield f"| `hydra.sweeper.{name}` | {_cell(meaning)} | `{default}` |\n"
    yield "\n"


def _options(group: str) -> str:
    """Return the options of a group as a list."""
    lines = [f"- `{group}={name}`: {text}" for name, text in group_options(group).items()]
    return "\n".join(lines) + "\n\n"


def _of_kind(group: str, kind: str) -> Mapping[str, Any]:
    """Return the values of the option named like a kind, else of the group's usual one.

    A file of the root's package holds them below its group.
    """
    own = place_in(conf_dir(), f"{group}/{kind}.yaml").exists()
    values = _read(f"{group}/{kind if own else _OPTION.get(group, 'none')}")
    return dict(values.get(group, values))


def _read(name: str) -> dict[str, Any]:
    return dict(yaml.safe_load(place_in(conf_dir(), f"{name}.yaml").read_text(encoding="utf-8")))


def _table(group: str, model: type[StrictModel], defaults: Mapping[str, Any]) -> str:
    return _lines(_rows(group, model, defaults))


def _kind_rows(group: str, kind: str, registry: "Kinds[Any]") -> Iterator[tuple[str, str, str, str]]:
    """Yield the rows of a kind's keys, without the key that names the kind."""
    rows = _rows(group, registry.config_model(kind), _of_kind(group, kind))
    yield from (row for row in rows if row[0] != f"`{group}.kind`")


def _lines(rows: Iterable[Sequence[str]]) -> str:
    lines = ["| Key | Meaning | Allowed | Default |", "|---|---|---|---|"]
    lines += [f"| {' | '.join(_cell(cell) for cell in row)} |" for row in rows]
    return "\n".join(lines) + "\n\n"


def _keys_of(rows: Iterable[Sequence[str]]) -> str:
    """Return the names of keys below their group, without the keys below them."""
    return ", ".join(dict.fromkeys(f"`{key.strip('`').split('.')[1]}`" for key, *_ in rows))


def _merged(rows: Mapping[str, Sequence[tuple[str, str, str, str]]]) -> str:
    """Return one table of the keys of several kinds; kinds are named at a key that differs between them."""
    defaults: dict[tuple[str, str, str], dict[str, list[str]]] = {}
    for kind, own in rows.items():
        for *meaning, default in own:
            key, said, allowed = meaning
            defaults.setdefault((key, said, allowed), {}).setdefault(default, []).append(kind)
    having = Counter(key for own in rows.values() for key in {row[0] for row in own})
    merged = []
    for (key, said, allowed), by_default in sorted(defaults.items(), key=lambda item: item[0][0].strip("`")):
        kinds = [kind for some in by_default.values() for kind in some]
        of_kinds = f" ({', '.join(kinds)})" if len(kinds) < having[key] else ""
        values = [
            value if len(by_default) == 1 else f"{value} ({', '.join(some)})" for value, some in by_default.items()
        ]
        merged.append((key + of_kinds, said, allowed, ", ".join(values)))
    return _lines(merged)


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def _rows(group: str, model: type[StrictModel], defaults: Mapping[str, Any]) -> Iterator[tuple[str, str, str, str]]:
    said = meanings(model)
    for name, field in model.model_fields.items():
        key = f"{group}.{name}" if group else name
        inner = nested_model(field.annotation)
        given = defaults.get(name, None if field.is_required() else field.get_default())
        if inner is not None and isinstance(given, Mapping):
            yield from _rows(f"{key}.NAME" if get_origin(field.annotation) is dict else key, inner, given)
            continue
        default = "must be given" if name not in defaults and field.is_required() else f"`{_inline(given)}`"
        yield f"`{key}`", _null(said[name]), describe(field.annotation, field.metadata), default
        if inner is not None and given is None:
            yield from _rows(key, inner, {})


def _inline(value: Any) -> str:
    return yaml.safe_dump(value, default_flow_style=True, width=1000).removesuffix("\n").removesuffix("\n...")


def _null(text: str) -> str:
    """Return a docstring's words with None as YAML writes it."""
    return re.sub(r"\bNone\b", "`null`", text)


def _metrics() -> Iterator[str]:
    yield (
        "One value for each repetition, and their median, smallest and largest. A metric of one joint or axis carries "
        "it behind its name, as `peak_torque_q1` and `max_tracking_error_x`; of a carrying stage in front, as "
        "`macro_settling_time`. Rows of a trace are control ticks.\n\n| Metric | Unit | Formula |\n|---|---|---|\n"
    )
    for family in families():
        meanings = _bullets(family.evaluate.__doc__ or "")
        for name, unit in family.UNITS.items():
            yield f"| `{name}` | {unit} | {_cell(_null(meanings[name]))} |\n"
    yield "\n"


def _bullets(docstring: str) -> dict[str, str]:
    """Return the meaning that a docstring's bullets `- name, name: meaning.` give each name."""
    entries = re.findall(r"^\s*- ([\w, ]+): (.+?)(?=^\s*- |\Z)", docstring, re.M | re.S)
    return {name.strip(): " ".join(text.split()) for names, text in entries for name in names.split(",")}


def _chapters() -> Iterator[str]:
    yield "Functions for chapters of a [study](paper.md). `runs` is filled in.\n\n| Call | Result |\n|---|---|\n"
    for module in SHARED:
        for name, function in public_functions(module).items():
            call = f"{name}{_signature(function)}"
            meaning = (inspect.getdoc(function) or "").partition("\n\n")[0].replace("\n", " ").removeprefix("Return ")
            yield f"| `{_cell(call)}` | {_cell(meaning)} |\n"
    yield "\n"


def _signature(function: Callable[..., Any]) -> str:
    """Return a function's arguments as a chapter gives them, without types."""
    parameters = [each for name, each in inspect.signature(function).parameters.items() if name != "runs"]
    shown = [each.replace(annotation=inspect.Parameter.empty) for each in parameters]
    return str(inspect.Signature(shown))


def _commands() -> Iterator[str]:
    yield "Options of every command:\n\n| Argument | Meaning |\n|---|---|\n"
    yield from _arguments(COMMON)
    yield "\n"
    parsers = build_parser(name for name in commands.names() if name != "sweep").commands
    for name, parser in parsers.items():
        example = str(parser.epilog).splitlines()[0].replace(": ", ": `", 1)
        yield f"### runner {name}\n\n{parser.description}\n\n{example}`\n\n"
        yield "| Argument | Meaning |\n|---|---|\n"
        yield from _arguments(parser)
        yield "\n"


def _arguments(parser: argparse.ArgumentParser, before: str = "") -> Iterator[str]:
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, own in action.choices.items():
                yield from _arguments(own, f"{name} ")
        elif not isinstance(action, argparse._HelpAction) and (parser is COMMON or action not in COMMON._actions):
            words = ", ".join(action.option_strings) or str(action.metavar or action.dest)
            value = f" {action.metavar}" if action.option_strings and action.metavar else ""
            yield f"| `{before}{words}{value}` | {_cell(str(action.help) % vars(action))} |\n"


if __name__ == "__main__":
    PAGE.write_text(reference_text(), encoding="utf-8")
    print(PAGE.name)
