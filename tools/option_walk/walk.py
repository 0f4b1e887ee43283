"""Changes of one option at a time, and their effects."""

import json
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import fields, is_dataclass
from functools import cache
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np

from runner.assembly.validation import validate
from runner.base.errors import ConfigError
from runner.config.compose.compose import compose
from runner.plants import PLANTS
from runner.simulation.run import simulate_run
from runner.store import run_hash
from runner.symbolic import engine
from tools.option_walk.keys import Key, keys_of, known_keys
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
        kind: Group and kind of the key.
    """

    scene: str
    engine: str
    change: str
    kind: str = ""

    @property
    def key(self) -> str:
        """The key that it changes."""
        return self.change.lstrip("+").partition("=")[0]


class Judged(NamedTuple):
    """A change with its verdict.

    Attributes:
        step: The change.
        verdict: Its verdict.
        words: What was reported.
    """

    step: Step
    verdict: Verdict
    words: str

    def __str__(self) -> str:
        return f"{self.step.engine}, {self.step.scene}: {self.verdict} {self.step.change} {self.words}"


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
    """Return the changes of a scene on a plant; none if the plant rejects the run without a change."""
    scene, base = SCENES[name], base_of(name, engine_name)
    try:
        config = validate(compose(base, [folder]))
    except ConfigError:
        return []
    options = [(option.replace("=", " "), option) for option in scene.options if option not in base]
    changes = [
        (key.kind, f"++{key.name}={_typed(value)}")
        for key, values in changed_keys(scene, config.resolved, config.arm.model.joint_names[0])
        for value in values
    ]
    return [Step(name, engine_name, change, kind) for kind, change in (*options, *changes)]


def changed_keys(scene: Scene, resolved: Mapping[str, Any], first_joint: str) -> Iterator[tuple[Key, Sequence[Any]]]:
    """Yield the keys of a config that a scene changes, with the values to which they change."""
    for key in keys_of(resolved):
        if _is_in(key.name, scene.feels) and not _is_in(key.name, [*scene.but, *LEFT_OUT]):
            values = _others(key.name, key.value, key.allowed, first_joint)
            if values:
                yield key, values


def unwalked() -> list[tuple[str, str]]:
    """Return each kind and key of the walked groups that no scene changes."""
    walked = set[tuple[str, str]]()
    for name in SCENES:
        try:
            resolved = compose(base_of(name, "rk4")).resolved
        except ConfigError:
            resolved = compose(base_of(name, "rk4_flexible")).resolved  # motor_pd takes the springs of the plant
        walked |= _changed_in(name, resolved)
    for engine_name in ("bullet", "mujoco", "rk4_flexible", "rk4_flexible_links"):  # each has own keys
        walked |= _changed_in("arm", compose(base_of("arm", engine_name)).resolved)
    missing = [(kind, key) for kind, key in known_keys() if (kind, key) not in walked and not _is_in(key, LEFT_OUT)]
    return sorted([*missing, *(("plant", kind) for kind in PLANTS.names() if kind not in ENGINES)])


def _changed_in(name: str, resolved: Mapping[str, Any]) -> set[tuple[str, str]]:
    return {(key.kind, key.name) for key, _ in changed_keys(SCENES[name], resolved, "joint1")}


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
        try:
            after = self._run([*base, step.change])
        except Exception as error:  # any other exception is a fault
            return "CRASHED", f"{type(error).__name__}: {error}"
        if after.reason:
            return "rejected", after.reason
        if after.content != before.content:
            same = after.name == before.name
            return ("NOT IN THE HASH", "") if same else ("acts", "")
        own = {text for text in after.reported if text.startswith(f"{step.key}: ")}  # the run may report it already
        if new := (after.reported - before.reported) | own:
            return "reported", "; ".join(sorted(new))
        reason = next(
            (EXCEPTIONS[text] for text in (f"{step.scene} {step.key}", step.key, step.change) if text in EXCEPTIONS), ""
        )
        return ("excepted", reason) if reason else ("SILENT", "")

    def _run(self, overrides: Sequence[str]) -> Outcome:
        try:
            config = validate(compose(overrides, [self._folder]))
            result = simulate_run(config)
        except ConfigError as error:
            return Outcome("", b"", frozenset(), str(error))
        reported = [*result.provenance["warnings"], *(caveat.text for caveat in result.caveats.caveats)]
        values = {name: list(map(float, summary.values)) for name, summary in result.metrics.items()}
        measured = repr((result.failure, result.plant_error, result.rounding)).encode()
        content = [*_arrays(result.trace), json.dumps(values, sort_keys=True).encode(), measured]
        return Outcome(run_hash(config.resolved, config.arm.urdf), b"".join(content), frozenset(reported))


def _arrays(part: Any) -> Iterator[bytes]:
    """Yield the arrays of a trace as bytes."""
    for field in fields(part):
        value = getattr(part, field.name)
        if is_dataclass(value):
            yield from _arrays(value)
        elif isinstance(value, np.ndarray) and field.name not in _UNCLOCKED:
            yield np.ascontiguousarray(value).tobytes()


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


def _is_in(key: str, groups: Iterable[str]) -> bool:
    return any(key == group or key.startswith(f"{group}.") for group in groups)


@cache
def _number(value: float) -> float:
    return 1.1 * value if value else 0.01


def _moved(value: Any) -> Any:
    """Return a value that differs visibly; None if no rule is known for its type."""
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return value + 1
    if isinstance(value, float):
        return _number(value)
    if isinstance(value, list | Mapping) and value:
        names = list(value) if isinstance(value, Mapping) else range(len(value))
        moved = {name: _moved(value[name]) for name in names}
        if None not in moved.values():
            return moved if isinstance(value, Mapping) else list(moved.values())
    return None


def _typed(value: Any) -> str:
    """Return a value as an override contains it."""
    if isinstance(value, Mapping):
        return "{" + ",".join(f"{name}:{_typed(each)}" for name, each in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ",".join(map(_typed, value)) + "]"
    return "null" if value is None else str(value).lower() if isinstance(value, bool) else str(value)
