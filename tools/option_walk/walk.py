"""Changes of one option at a time, and their effects."""

import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import fields, is_dataclass
from functools import cache
from pathlib import Path
from typing import Any, Literal, NamedTuple, get_args, get_origin

import numpy as np

from runner.base.errors import ConfigError
from runner.config.compose.compose import compose
from runner.config.groups import GROUPS
from runner.config.settings import RunSettings
from runner.config.validation import validate
from runner.plugins.registry import Kinds
from runner.schema.model import StrictModel, nested_model
from runner.simulation.run import simulate_run
from runner.store import run_hash
from runner.symbolic import engine
from tools.option_walk.scenes import CHANGED, ENGINES, EXCEPTIONS, LEFT_OUT, SCENES, Scene

Verdict = Literal["acts", "reported", "rejected", "excepted", "SILENT", "NOT IN THE HASH", "CRASHED"]
FAULTS = ("SILENT", "NOT IN THE HASH", "CRASHED")
_UNCLOCKED = ("tick_seconds", "law_seconds")
_SLOW = 1e-4  # rad/s


class Step(NamedTuple):
    """A change of one option in a run.

    Attributes:
        scene: Name of the scene.
        engine: Name of the plant.
        change: The override.
    """

    scene: str
    engine: str
    change: str


class Outcome(NamedTuple):
    """Result of a run, or the reason why it is rejected.

    Attributes:
        name: Hash of the run; empty if it is rejected.
        content: Signals and metrics as bytes.
        reported: Warnings and caveats.
        reason: Reason of the rejection.
    """

    name: str
    content: bytes
    reported: frozenset[str]
    reason: str = ""


@contextmanager
def interpreted() -> Iterator[None]:
    """Interpret all runs within the context, as without llvmlite."""
    kept = sys.modules.get(engine.NAME)
    sys.modules[engine.NAME] = None  # type: ignore[assignment] # how Python marks a missing module
    engine.evaluator.cache_clear()
    try:
        yield
    finally:
        del sys.modules[engine.NAME]
        if kept is not None:
            sys.modules[engine.NAME] = kept
        engine.evaluator.cache_clear()


def steps_of(name: str, engine_name: str, folder: Path) -> list[Step]:
    """Return the changes of a scene on a plant; those of the plainest run if the plant rejects the scene's."""
    scene, base = SCENES[name], base_of(name, engine_name)
    try:
        config = validate(compose(base, [folder]))
    except ConfigError:
        return []
    found = [option for option in scene.options if option not in base]
    joint = config.arm.model.joint_names[0]
    for key, value, allowed in _leaves(config.resolved):
        if _is_in(key, scene.feels) and not _is_in(key, [*scene.but, *LEFT_OUT]):
            found += [f"++{key}={_typed(each)}" for each in _others(key, value, allowed, joint)]
    return [Step(name, engine_name, change) for change in found]


def base_of(name: str, engine_name: str) -> list[str]:
    """Return the overrides of a scene on a plant."""
    own = SCENES[name].overrides.split()
    chosen = {text.partition("=")[0]: text for text in [*own[:1], *ENGINES[engine_name], *own[1:]]}
    return list(chosen.values())


class Walk:
    """Judges changes; keeps the runs without a change.

    Args:
        folder: Config folder of the made-up kinds.
    """

    def __init__(self, folder: Path) -> None:
        self._folder, self._kept = folder, dict[tuple[str, ...], Outcome]()

    def judge(self, step: Step) -> tuple[Verdict, str]:
        """Return the verdict on a change, and what was reported."""
        base = base_of(step.scene, step.engine)
        before = self._kept.get(tuple(base)) or self._kept.setdefault(tuple(base), self._run(base))
        key = step.change.lstrip("+").partition("=")[0]
        try:
            after = self._run([*base, step.change])
        except Exception as error:  # any other exception is a fault
            return "CRASHED", f"{type(error).__name__}: {error}"
        if after.reason:
            return "rejected", after.reason
        if after.content != before.content:
            same = after.name == before.name
            return ("NOT IN THE HASH", "") if same else ("acts", "")
        if new := after.reported - before.reported:
            return "reported", "; ".join(sorted(new))
        reason = EXCEPTIONS.get(f"{step.scene} {key}") or EXCEPTIONS.get(key) or EXCEPTIONS.get(step.change.lstrip("+"))
        return ("excepted", reason) if reason else ("SILENT", "")

    def _run(self, overrides: Sequence[str]) -> Outcome:
        try:
            config = validate(compose(overrides, [self._folder]))
            result = simulate_run(config)
        except ConfigError as error:
            return Outcome("", b"", frozenset(), str(error))
        reported = [*result.provenance["warnings"], *(caveat.text for caveat in result.caveats.caveats)]
        values = {name: list(map(float, summary.values)) for name, summary in result.metrics.items()}
        content = [*_arrays(result.trace), json.dumps(values, sort_keys=True).encode(), repr(result.failure).encode()]
        return Outcome(run_hash(config.resolved, config.arm.urdf), b"".join(content), frozenset(reported))


def _arrays(part: Any) -> Iterator[bytes]:
    """Yield the arrays of a trace as bytes."""
    for field in fields(part):
        value = getattr(part, field.name)
        if is_dataclass(value):
            yield from _arrays(value)
        elif isinstance(value, np.ndarray) and field.name not in _UNCLOCKED:
            yield np.ascontiguousarray(value).tobytes()


def _is_in(key: str, groups: Sequence[str]) -> bool:
    return any(key == group or key.startswith(f"{group}.") for group in groups)


def _leaves(resolved: Mapping[str, Any]) -> Iterator[tuple[str, Any, Sequence[Any]]]:
    """Yield the dotted key, value and allowed words of each key of a config."""
    for group, content in resolved.items():
        if group not in GROUPS:
            field = RunSettings.model_fields.get(group)
            yield group, content, _words(field.annotation) if field else ()
            continue
        known = GROUPS[group]
        model = known.config_model(content.get("kind", known.default)) if isinstance(known, Kinds) else known
        yield from _of_model(group, content, model)


def _of_model(
    place: str, content: Mapping[str, Any], model: type[StrictModel]
) -> Iterator[tuple[str, Any, Sequence[Any]]]:
    for name, value in content.items():
        field, key = model.model_fields.get(name), f"{place}.{name}"
        inner = nested_model(field.annotation) if field else None
        if field is None or name == "kind":
            continue
        if inner is not None and isinstance(value, Mapping) and not _is_dict(field.annotation):
            yield from _of_model(key, value, inner)
        else:
            yield key, value, _words(field.annotation)


def _is_dict(annotation: Any) -> bool:
    return any(get_origin(part) is dict for part in (annotation, *get_args(annotation)))


def _words(annotation: Any) -> list[Any]:
    """Return the words that an annotation allows."""
    if get_origin(annotation) is Literal:
        return list(get_args(annotation))
    return [word for part in get_args(annotation) for word in _words(part)]


def _others(key: str, value: Any, allowed: Sequence[Any], first_joint: str) -> list[Any]:
    """Return the values to which a key changes: other words, and a number or list that differs visibly."""
    if key == "robot.velocity_limits":
        return [{first_joint: _SLOW}]
    if key in CHANGED:
        return [CHANGED[key]] if CHANGED[key] != value else []
    if isinstance(value, str) and allowed:
        return [word for word in allowed if word != value]
    changed = _moved(value)
    return [] if changed is None else [changed]


@cache
def _number(value: float) -> float:
    return 1.1 * value if value else 0.01


def _moved(value: Any) -> Any:
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return value + 1
    if isinstance(value, float):
        return _number(value)
    if isinstance(value, list) and value and all(isinstance(each, float) for each in value):
        return [_number(each) for each in value]
    if isinstance(value, Mapping) and value and all(isinstance(each, float) for each in value.values()):
        return {name: _number(each) for name, each in value.items()}
    return None


def _typed(value: Any) -> str:
    """Return a value as an override contains it."""
    if isinstance(value, Mapping):
        return "{" + ",".join(f"{name}:{_typed(each)}" for name, each in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ",".join(map(_typed, value)) + "]"
    return "null" if value is None else str(value).lower() if isinstance(value, bool) else str(value)


__all__ = ["FAULTS", "SCENES", "Scene", "Step", "Walk", "interpreted", "steps_of"]
