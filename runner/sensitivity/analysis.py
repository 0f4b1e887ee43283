"""The derivatives of a run's metrics by its parameters."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from runner.assembly import assemble_whole, metric_context
from runner.batch import Batcher, Together, Wanted
from runner.compiled.directed import Setting, tangents
from runner.compiled.engine import evaluator
from runner.config.flexible_joints import find_flexibility
from runner.config.flexible_links import is_flexible
from runner.config.run import RunConfig
from runner.errors import ConfigError, RunnerError
from runner.metrics import measure, of_run
from runner.plants import PLANTS
from runner.plants.rk4 import Rk4Config
from runner.sensitivity.parameters import GROUPS, Parameter, find_parameters
from runner.sensitivity.slopes import NotSmoothError, Scene
from runner.sensitivity.smooth_metrics import Change, derivatives
from runner.trace import FloatArray, Trace

Validated = Callable[[Mapping[str, Any]], RunConfig]


@dataclass(frozen=True)
class Sensitivity:
    """How a run's metrics change with its parameters.

    Attributes:
        scene: The run.
        metrics: Its smooth metrics by name.
        parameters: The parameters on which it depends.
        derivatives: Of each metric by each parameter, shape (parameters,).
        left_out: Parameters by which there is no derivative, and why.
        error: Root mean square of the tip's error over the run, in m.
        moves: Largest way of the tip by each parameter, per relative change of it, shape (parameters,), in m.
    """

    scene: Scene
    metrics: Mapping[str, float]
    parameters: Sequence[Parameter]
    derivatives: Mapping[str, FloatArray]
    left_out: Sequence[str]
    error: float
    moves: FloatArray

    def elasticities(self, metric: str) -> FloatArray:
        """Return d ln metric / d ln parameter of each parameter, shape (parameters,); NaN where the metric is 0."""
        value = self.metrics[metric]
        values = np.array([parameter.value for parameter in self.parameters])
        found: FloatArray = self.derivatives[metric] * values / value if value else np.full(len(values), np.nan)
        return found

    def ranked(self, metric: str) -> list[int]:
        """Return the places of the parameters, first the one that matters most."""
        size = np.abs(self.elasticities(metric) if self.metrics[metric] else self.derivatives[metric])
        places: list[int] = np.argsort(-size, kind="stable").tolist()
        return places


def analyse(
    config: RunConfig, validated: Validated, groups: Sequence[str] = GROUPS, repetition: int = 0
) -> Sensitivity:
    """Return the derivatives of all smooth metrics of a run by its parameters; of a compiled Runge-Kutta plant.

    Args:
        config: The run's checked config.
        validated: Checks a resolved config.
        groups: Which parameters, some of GROUPS.
        repetition: Number of the repetition.

    Raises:
        RunnerError: where the run has no compiled form, ends early, or depends on no such parameter.
        ConfigError: where it cannot start.
    """
    scene = scene_of(by_runge_kutta(config, validated), repetition)
    trace, metrics = simulated(scene)
    parameters, slopes, left_out = slopes_of(scene, find_parameters(scene.config, groups, validated))
    if not parameters:
        raise RunnerError(f"the run depends on no parameter of {', '.join(groups)}; allowed: {', '.join(GROUPS)}")
    whole = scene.whole
    moved = tangents(whole, scene.setting, slopes, whole.commands.shared(trace.t, trace.desired))
    acted = np.maximum(np.arange(len(trace.t)) - whole.delay, 0)
    change = Change(moved.q, moved.dq, moved.torque[:, acted], moved.end_points)
    found = derivatives(trace, change, metric_context(scene.config))
    known = {name: metrics[name] for name in metrics if name in found}
    values = {name: value for name, value in known.items() if value is not None}
    sizes = np.array([parameter.value for parameter in parameters])
    return Sensitivity(
        scene=scene,
        metrics=values,
        parameters=parameters,
        derivatives={name: found[name] for name in values},
        left_out=left_out,
        error=float(np.sqrt((trace.error**2).sum(axis=1).mean())),
        moves=np.abs(moved.end_points[-1]).max(axis=(1, 2)) * np.abs(sizes),
    )


def by_runge_kutta(config: RunConfig, validated: Validated) -> RunConfig:
    """Return the config of a run with the Runge-Kutta plant in the place of another one that takes torques."""
    if config.plant.kind == "rk4" or is_flexible(config) or PLANTS.commands(config.plant.kind) != "torque":
        return config
    plant: Any = config.resolved["plant"]
    kept = {key: value for key, value in plant.items() if key in Rk4Config.model_fields}
    return validated({**config.resolved, "plant": {**kept, "kind": "rk4", "step": None}})


def simulated(run: Wanted) -> tuple[Trace, Mapping[str, float | None]]:
    """Return the trace and metrics of one run.

    Raises:
        RunnerError: where it ends early.
    """
    (found,) = Batcher().simulate([run])
    if not isinstance(found, Together):
        failure = found[1].failure
        assert failure is not None  # noqa: S101 - it is why the run is not among those that ended well
        raise RunnerError(f"the run has no derivatives: it ended at {failure.time:g} s, {failure.reason}")
    return found.traces.run(0), of_run(measure(found.traces, found.context), 0)


def scene_of(config: RunConfig, repetition: int) -> Scene:
    """Return a repetition of a run that is compiled whole.

    Raises:
        RunnerError: where it is not, with the reason.
        ConfigError: where it cannot start.
    """
    why = _why_not(config)
    found = None if why else assemble_whole(config, repetition)
    if found is None:
        why = why or f"the law {config.controller.kind} has no compiled form, or the arm too many joints"
        raise RunnerError(f"no derivatives of this run: {why}")
    return Scene(config, repetition, *found)


def _why_not(config: RunConfig) -> str:
    """Return why a run has no derivatives; nothing where it may have."""
    if not evaluator():
        return "llvmlite, which compiles runs, is not installed; `pip install llvmlite`"
    if config.commands != "torque":
        return f"controller {config.controller.kind} commands joint positions; only laws that give torques are compiled"
    if find_flexibility(config) is not None:
        return "plant.flexible_joints: runs of arms with flexible joints are not compiled; take plant=rk4"
    if is_flexible(config):
        return "plant.links: runs of arms whose links bend are not compiled; take plant=rk4"
    if config.feels:
        return f"environment {config.environment.kind}: runs in which the tip feels something are not compiled whole"
    if config.plugged:
        kinds = ", ".join(f"{group}={part.kind}" for group, part in config.plugged.items())
        return f"runs with {kinds} of a plug-in are not compiled"
    if (config.noise.resolution > 0.0).any():
        return "noise.resolution rounds the measured positions to steps, which have no derivative; set it to 0"
    return ""


def slopes_of(scene: Scene, parameters: Sequence[Parameter]) -> tuple[list[Parameter], list[Setting], list[str]]:
    """Return the parameters on which a run depends, how, and by which there is no derivative."""
    known: list[Parameter] = []
    slopes: list[Setting] = []
    left_out: list[str] = []
    for parameter in parameters:
        try:
            slope = scene.slope(parameter)
        except NotSmoothError as error:
            left_out.append(str(error))
        except ConfigError as error:
            left_out.append(f"{parameter.name}: a value beside its own is not allowed: {'; '.join(error.problems)}")
        else:
            if any(part.any() for part in (slope.numbers, slope.start, *slope.errors)):
                known.append(parameter)
                slopes.append(slope)
    return known, slopes, left_out
