"""Derivatives of the inputs of a closed loop by a parameter, exact to rounding."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

import numpy as np

from runner.analysis.parameters import NumericKey, Parameter
from runner.assembly.assemble import describe_program, start_of
from runner.assembly.compiled.law import structure_cache_key
from runner.assembly.compiled.loop_program import LoopProgram, Setting
from runner.assembly.run_config import RunConfig
from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError, RunnerError
from runner.simulation.batch import RunSpec, draw_errors

_PART = 1.0 / 512.0  # step as a fraction of the parameter's value; the stencil has nine points
_EIGHTH = (4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0)  # exact for polynomials up to degree 8
_SIXTH = (3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0, 0.0)
_AGREES, _ROUNDING = 1e-9, 1e-12
_CODE = "it changes the code of the law"


class NoDerivativeError(RunnerError):
    """A run has no derivative by a parameter; the message is the reason why."""


class Scene(RunSpec):
    """One repetition of a run, with the derivatives of its inputs."""

    @property
    def setting(self) -> Setting:
        """Inputs of the run: numbers of the loop, start state and encoder errors."""
        errors = [wrong[0] for wrong in draw_errors([self], self.rows)]
        start = self.loop_program.commands.start(self.q_start[None], [wrong[:1] for wrong in errors])[0]
        return Setting(self.loop_program.numbers, start, errors)

    def at(self, parameter: Parameter, value: float) -> "Scene":
        """Return the run with another value of a parameter; the start of the arm and the desired motion do not change.

        Raises:
            NoDerivativeError: if the value changes the ticks, the steps or the code of the law.
            ConfigError: if the value is not allowed.
        """
        return self._changed(parameter.with_value(value))

    def _changed(self, config: RunConfig) -> "Scene":
        loop_program = describe_program(config, self.repetition)
        if loop_program is None or config.timing != self.config.timing:
            raise NoDerivativeError("it changes the ticks or steps of the run, which are held")
        if _fixed(loop_program) != _fixed(self.loop_program):
            raise NoDerivativeError(_CODE)
        # Metrics depend on the arm, for example on its home configuration.
        return replace(
            self, config=replace(config, arm=self.config.arm, path=self.config.path), loop_program=loop_program
        )

    def depends(self, config: RunConfig) -> bool:
        """Return True if another config gives another run.

        Raises:
            NoDerivativeError: if the dependence has no derivative.
            ConfigError: if the other run cannot start.
        """
        times: FloatArray = np.arange(self.rows, dtype=np.float64) * self.loop_program.tick
        if not np.array_equal(_motion(self.config, times), _motion(config, times)):
            raise NoDerivativeError("it changes the desired motion, which is held")
        if not np.array_equal(start_of(config), self.q_start):
            raise NoDerivativeError("it changes the start, which is held")
        return not np.array_equal(_vector(self.setting), _vector(self._changed(config).setting))

    def slope(self, parameter: Parameter) -> Setting:
        """Return the derivatives of the inputs of the run by a parameter.

        These inputs are polynomials of low degree in a parameter, such as omega_n^2, or ratios of polynomials. So
        central differences of eighth order are exact to rounding, and those of sixth order must agree.

        Raises:
            NoDerivativeError: if the two differences do not agree.
            ConfigError: if a neighbouring value of the parameter is not allowed.
        """
        base, h = self.setting, _PART * parameter.value
        scenes = {step: self.at(parameter, parameter.value + step * h) for step in (*range(-4, 0), *range(1, 5))}
        settings = {step: scene.setting for step, scene in scenes.items()}

        def derivative(of: Callable[[Setting], FloatArray]) -> FloatArray:
            taken = {step: of(setting) for step, setting in settings.items()}
            if any(value.shape != of(base).shape for value in taken.values()):
                raise NoDerivativeError(_CODE)
            finite = np.isfinite(of(base))  # an infinite limit stays infinite
            taken = {step: np.where(finite, value, 0.0) for step, value in taken.items()}
            found, other = (
                sum(weight * (taken[step] - taken[-step]) for step, weight in enumerate(weights, start=1)) / h
                for weights in (_EIGHTH, _SIXTH)
            )
            near = np.abs(np.where(finite, of(base), 0.0)) / abs(parameter.value)
            size = np.maximum(np.abs(found), near)
            # After cancellation of large numbers, the rounding error is relative to their size.
            if not np.all(np.abs(found - other) <= _AGREES * size + _ROUNDING * near.max(initial=0.0)):
                raise NoDerivativeError("the numbers of the loop are no smooth functions of it")
            exact: FloatArray = np.where(np.abs(found) <= _ROUNDING * size, 0.0, found)
            return exact

        return Setting(
            derivative(lambda setting: setting.numbers),
            derivative(lambda setting: setting.start),
            [derivative(lambda setting, n=number: setting.errors[n]) for number in range(len(base.errors))],  # type: ignore[misc]
        )


def _fixed(loop_program: LoopProgram) -> list[str]:
    return [structure_cache_key(loop.law) for loop in loop_program.commands.loops]


def _motion(config: RunConfig, times: FloatArray) -> FloatArray:
    """Return the desired motion of the tip at some times, and that of the joints if there is one, as one array."""
    tip, joints = config.path.sample(times), config.path.sample_joints(times)
    return np.concatenate([np.ravel(part) for part in (tip, joints) if part is not None])


def _vector(setting: Setting) -> FloatArray:
    return np.concatenate([part.ravel() for part in (setting.numbers, setting.start, *setting.errors)])


@dataclass
class Slopes:
    """Derivatives of the inputs of a run by its parameters.

    Attributes:
        scene: The run.
        parameters: The parameters.
        settings: Derivatives of the inputs by each parameter.
        left_out: Names of the parameters without a derivative, by the reason.
    """

    scene: Scene
    parameters: list[Parameter] = field(default_factory=list)
    settings: list[Setting] = field(default_factory=list)
    left_out: dict[str, list[str]] = field(default_factory=dict)

    def add_key(self, key: NumericKey) -> None:
        """Add the numbers of a key if the run depends on them."""
        with self._leaving_out(key.name):
            changed = key.changed(_PART)
            if self.scene.depends(changed):
                for parameter in key.parameters(changed):
                    self.add(parameter)

    def add(self, parameter: Parameter) -> None:
        """Add a parameter if the run depends on it and no other parameter has the same effect."""
        with self._leaving_out(parameter.name):
            if parameter.value == 0.0:
                raise NoDerivativeError("its value is 0 (a small value shows its effect)")
            found = self.scene.slope(parameter)
            shares = parameter.value * _vector(found)
            if not shares.any():
                return
            for other, setting in zip(self.parameters, self.settings, strict=True):
                own = other.value * _vector(setting)
                if np.allclose(shares, own, rtol=_AGREES, atol=_AGREES * np.abs(own).max()):
                    raise NoDerivativeError(f"it has the same effect as {other.name}")
            self.parameters.append(parameter)
            self.settings.append(found)

    @contextmanager
    def _leaving_out(self, name: str) -> Iterator[None]:
        try:
            yield
        except NoDerivativeError as error:
            self.left_out.setdefault(str(error), []).append(name)
        except ConfigError as error:
            why = error.problems[0].partition("; found")[0].split(": ", 1)[-1]
            self.left_out.setdefault(f"values near its own are refused: {why}", []).append(name)
