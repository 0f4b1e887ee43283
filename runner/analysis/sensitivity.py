"""Derivatives of the metrics of a run by its parameters, and central differences of whole runs to check them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np

from runner.analysis.parameters import GROUPS, Parameter, find_keys, find_links
from runner.analysis.slopes import Scene, Slopes
from runner.analysis.smooth_metrics import derivatives
from runner.assembly.assemble import assemble_program
from runner.assembly.compiled.loop_program import tangents
from runner.assembly.flexibility import find_flexibility, is_flexible
from runner.assembly.run_config import RunConfig
from runner.assembly.validation import validate
from runner.assembly.versions import has_compiler
from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError, RunnerError
from runner.base.trace import Trace
from runner.config.compose.compose import compose
from runner.config.composed import Composed
from runner.config.groups import GROUPS as MODELS
from runner.config.parsing import require
from runner.metrics import summary
from runner.metrics.summary import measure
from runner.plugins.registry import Kinds
from runner.simulation.batch import BatchResult, BatchSimulator, RunSpec
from runner.simulation.results import metric_context
from runner.store import Run, simulated_part


@dataclass(frozen=True)
class Sensitivity:
    """Derivatives of the metrics of a run by its parameters.

    Attributes:
        scene: The run.
        metrics: Values of the smooth metrics by name.
        parameters: The parameters on which the run depends.
        derivatives: Derivatives of each metric by the parameters, shape (parameters,), by the name of the metric.
        left_out: Names of the parameters without a derivative, by the reason.
        error: RMS tip error over the run, in m.
        moves: Largest change of a tip coordinate per relative change of each parameter, shape (parameters,), in m.
    """

    scene: Scene
    metrics: Mapping[str, float]
    parameters: Sequence[Parameter]
    derivatives: Mapping[str, FloatArray]
    left_out: Mapping[str, Sequence[str]]
    error: float
    moves: FloatArray

    def elasticities(self, metric: str) -> FloatArray:
        """Return d ln metric / d ln parameter for each parameter, shape (parameters,); NaN if the metric is 0."""
        value = self.metrics[metric]
        values = np.array([parameter.value for parameter in self.parameters])
        found: FloatArray = self.derivatives[metric] * values / value if value else np.full(len(values), np.nan)
        return found

    def ranked(self, metric: str) -> list[int]:
        """Return the indices of the parameters, the one with the largest effect first."""
        size = np.abs(self.elasticities(metric) if self.metrics[metric] else self.derivatives[metric])
        places: list[int] = np.argsort(-size, kind="stable").tolist()
        return places


def analyse(composed: Composed, groups: Sequence[str] = GROUPS, repetition: int = 0) -> Sensitivity:
    """Return the derivatives of all smooth metrics of a run by its parameters, for a compiled Runge-Kutta plant.

    A derivative by a config key includes the keys that refer to it, as in `${controller.natural_frequency}`: the config
    is composed again with another value of the key.

    Args:
        composed: Config of the run with its overrides.
        groups: Groups of the parameters, from GROUPS.
        repetition: Index of the repetition.

    Raises:
        RunnerError: if the run has no compiled form, ends early, or depends on no parameter of the groups.
        ConfigError: if the run cannot start.
    """
    slopes = slopes_of(composed, groups, repetition)
    scene = slopes.scene
    trace, metrics = simulate_run(scene)
    parameters = slopes.parameters
    if not parameters:
        why = "".join(f"; {', '.join(names)}: {reason}" for reason, names in slopes.left_out.items())
        raise RunnerError(f"the run depends on no parameter of {', '.join(groups)}{why}; allowed: {', '.join(GROUPS)}")
    loop_program = scene.loop_program
    shared = loop_program.commands.shared(trace.t, trace.desired, scene.config.path.sample_joints(trace.t))
    moved = tangents(loop_program, scene.setting, slopes.settings, shared)
    acted = np.maximum(np.arange(len(trace.t)) - loop_program.delay, 0)
    found = derivatives(trace, moved._replace(command=moved.command[:, acted]), metric_context(scene.config))
    known = {name: metrics[name] for name in metrics if name in found}
    values = {name: value for name, value in known.items() if value is not None}
    sizes = np.array([parameter.value for parameter in parameters])
    return Sensitivity(
        scene=scene,
        metrics=values,
        parameters=parameters,
        derivatives={name: found[name] for name in values},
        left_out=slopes.left_out,
        error=float(np.sqrt((trace.error**2).sum(axis=1).mean())),
        moves=np.abs(moved.end_points[-1]).max(axis=(1, 2)) * np.abs(sizes),
    )


def slopes_of(composed: Composed, groups: Sequence[str], repetition: int) -> Slopes:
    """Return the derivatives of the inputs of a repetition of a run; see analyse."""

    def recomposed(*overrides: str) -> RunConfig:
        again = compose([*composed.overrides, *overrides], composed.config_dirs) if overrides else composed
        return by_runge_kutta(again)

    slopes = Slopes(scene_of(recomposed(), repetition))
    for parameter in find_links(slopes.scene.config, groups):
        slopes.add(parameter)
    for key in find_keys(slopes.scene.config, groups, recomposed):
        slopes.add_key(key)
    return slopes


def by_runge_kutta(composed: Composed) -> RunConfig:
    """Return the checked config of a run; the Runge-Kutta plant replaces any other plant that takes torques."""
    config = validate(composed)
    if config.plant.kind == "rk4" or is_flexible(config) or not config.takes_torques:
        return config
    plant: Any = composed.resolved["plant"]
    known = cast(Kinds, MODELS["plant"]).config_model("rk4").model_fields
    kept = {key: value for key, value in plant.items() if key in known}
    changed = {**composed.resolved, "plant": {**kept, "kind": "rk4", "step": None}}
    return validate(replace(composed, resolved=changed))


def simulate_run(run: RunSpec) -> tuple[Trace, Mapping[str, float | None]]:
    """Return the trace and metrics of one run.

    Raises:
        RunnerError: if the run ends early.
    """
    (found,) = BatchSimulator().simulate([run])
    if not isinstance(found, BatchResult):
        failure = found[1].failure
        assert failure is not None  # noqa: S101 - only failed runs are not a BatchResult
        raise RunnerError(f"the run has no derivatives: it ended at {failure.time:g} s, {failure.reason}")
    return found.traces[0], summary.of_run(measure(found.traces, found.context), 0)


def scene_of(config: RunConfig, repetition: int) -> Scene:
    """Return a repetition of a run whose closed loop is compiled.

    Raises:
        RunnerError: if the closed loop is not compiled; the message contains the reason.
        ConfigError: if the run cannot start.
    """
    why = _why_not(config)
    found = None if why else assemble_program(config, repetition)
    if found is None:
        why = why or f"the law {config.controller.kind} has no compiled form, or the arm too many joints"
        raise RunnerError(f"no derivatives of this run: {why}")
    return Scene(config, repetition, *found)


def _why_not(config: RunConfig) -> str:
    """Return the reason why a run has no derivatives; empty if no reason is found."""
    if not has_compiler():
        return "llvmlite, which compiles runs, is not installed; `pip install llvmlite`"
    if config.commands != "torque":
        return f"controller {config.controller.kind} commands joint positions; only laws that give torques are compiled"
    if find_flexibility(config) is not None:
        return "plant.flexible_joints: runs of arms with flexible joints are not compiled; take plant=rk4"
    if is_flexible(config):
        return "plant.links: runs of arms whose links bend are not compiled; take plant=rk4"
    if config.has_contact:
        return f"environment {config.environment.kind}: runs in which the tip feels something are not compiled whole"
    if config.interpreted:
        return f"{' and '.join(config.interpreted)}: such parts have no compiled form"
    if (require(config.encoder_noise).resolution > 0.0).any():
        return "noise.resolution rounds the measured positions to steps, which have no derivative; set it to 0"
    return ""


def of_run(run: Run, groups: Sequence[str] = GROUPS, repetition: int = 0) -> Sensitivity:
    """Return the derivatives of the smooth metrics of a stored run by its parameters; see analyse.

    Args:
        run: The run.
        groups: Groups of the parameters, from GROUPS.
        repetition: Index of the repetition.

    Raises:
        RunnerError: if the repetition does not exist, the overrides now give another run, or it has no derivatives.
    """
    count = int(run.record["repetitions"])
    if not 0 <= repetition < count:
        raise RunnerError(f"repetition: run {run.hash} has no repetition {repetition}. Allowed: 0 to {count - 1}.")
    try:
        composed = compose(run.overrides, run.config_dirs)
        arm = validate(composed).arm
    except ConfigError as error:
        raise RunnerError(f"run {run.hash} cannot be rerun: {'; '.join(error.problems)}") from None
    if arm.urdf != run.urdf:
        raise RunnerError(f"the file of the robot of {run.hash} has changed since the run; rerun it")
    before, now = simulated_part(run.config), simulated_part(composed.resolved)
    changed = sorted(key for key in {**before, **now} if before.get(key) != now.get(key))
    if changed:
        raise RunnerError(f"the command of run {run.hash} gives another {', '.join(changed)} today; rerun it")
    return analyse(composed, groups, repetition)


_LARGEST, _STEPS = 2.0**-8, 9  # fraction of the parameter and of the error; each step is half the previous one
_ROUNDING = 4e-15  # of metrics from lengths, angles or torques of about 1 in SI units


@dataclass(frozen=True)
class Differences:
    """Derivatives of a metric from differences.

    Attributes:
        derivatives: Derivative by each parameter, shape (parameters,).
        doubts: Error estimate of each derivative from its steps, shape (parameters,).
    """

    derivatives: FloatArray
    doubts: FloatArray


def differences(found: Sensitivity, names: Sequence[str]) -> dict[str, Differences]:
    """Return the derivatives of metrics by all parameters, from runs with the ordinary compiled code.

    Central differences at nine steps are extrapolated to step zero. The estimate with the best agreement between
    neighbours is taken (Ridders 1982, Advances in Engineering Software 4, 75-76).

    Args:
        found: The run with its exact derivatives.
        names: Names of the metrics.
    """
    # The tip moves by a small fraction of its error, so that the signs and the positions of maxima do not change.
    first = _LARGEST * np.minimum(1.0, found.error / np.maximum(found.moves, 1e-300))
    steps = first[:, None] * 0.5 ** np.arange(_STEPS)
    runs = [
        found.scene.at(parameter, parameter.value * (1.0 + side))
        for parameter, own in zip(found.parameters, steps.tolist(), strict=True)
        for step in own
        for side in (-step, step)
    ]
    values = np.full((len(names), len(runs)), np.nan)
    for part in BatchSimulator().simulate(runs):
        if isinstance(part, BatchResult):
            measured = measure(part.traces, part.context)
            values[:, part.places] = [measured[name] for name in names]
    pairs = values.reshape(len(names), len(found.parameters), _STEPS, 2)
    size = np.array([parameter.value for parameter in found.parameters])[:, None] * steps  # of a step
    slopes = (pairs[..., 1] - pairs[..., 0]) / (2.0 * size)
    # Gains can amplify rounding errors: the smallest steps then scatter although their error order is removed.
    smallest = (4.0 * slopes[..., -3:] - slopes[..., -4:-1]) / 3.0
    scatter = np.abs(np.diff(smallest)).max(axis=-1, keepdims=True) * np.abs(size[:, -1:])
    rounding = [
        np.maximum(_ROUNDING * max(1.0, abs(found.metrics[name])), own) / np.abs(size)
        for name, own in zip(names, scatter, strict=True)
    ]
    return {name: Differences(*_extrapolated(slopes[place], rounding[place])) for place, name in enumerate(names)}


def _extrapolated(slopes: FloatArray, rounding: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the limits of central differences and their error estimates, shapes (n,).

    Args:
        slopes: The differences, each at half the step of the previous one, shape (n, steps).
        rounding: Bound of the rounding error of each difference, shape (n, steps).
    """
    best, doubt = slopes[:, 0].copy(), np.full(len(slopes), np.inf)
    column = slopes
    for order in range(1, slopes.shape[1]):
        factor = 4.0**order
        after = (factor * column[:, 1:] - column[:, :-1]) / (factor - 1.0)
        gaps = np.maximum(np.abs(after - column[:, 1:]), np.abs(after - column[:, :-1])) + rounding[:, order:]
        for index in range(after.shape[1]):
            better = gaps[:, index] < doubt
            best[better], doubt[better] = after[better, index], gaps[better, index]
        column = after
    return best, doubt
