"""How the numbers of a closed loop change with a parameter, exact to rounding."""

import copy
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from runner.assembly import describe_loop
from runner.batch import Wanted
from runner.compiled.closed_loop import Whole
from runner.compiled.directed import Setting
from runner.compiled.structure import fixed_text
from runner.errors import RunnerError
from runner.sensing.encoders import encoder_errors
from runner.sensitivity.parameters import Parameter
from runner.trace import FloatArray

_PART = 1.0 / 64.0  # of a parameter's value, between the nine at which numbers are taken
_EIGHTH = (4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0)  # exact for polynomials of up to that degree
_SIXTH = (3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0, 0.0)
_AGREES, _ROUNDING = 1e-9, 1e-13


class NotSmoothError(RunnerError):
    """The numbers of a closed loop are no smooth functions of a parameter, or its code changes with it."""


class Scene(Wanted):
    """One repetition of a run, and how what it follows from changes with parameters."""

    @property
    def setting(self) -> Setting:
        """What it follows from."""
        loops, settings = self.whole.commands.loops, self.config.settings
        errors = [
            encoder_errors(
                [self.config.noise],
                [(settings.seed, self.repetition, number)],
                self.config.timing.ticks // loop.every + 1,
            )[0]
            for number, loop in enumerate(loops)
        ]
        start = self.whole.commands.start(self.q_start[None], [wrong[:1] for wrong in errors])[0]
        return Setting(self.whole.numbers, start, errors)

    def at(self, parameter: Parameter, value: float) -> "Scene":
        """Return the run with another value of a parameter; where the arm starts and the desired motion are held.

        Raises:
            ConfigError: where there is no such run.
        """
        config = parameter.with_value(value)
        found = describe_loop(config, self.repetition)
        assert found is not None  # noqa: S101 - it is of the same kinds as the run's
        whole = _with_laws_of(self.whole, found) if parameter.holds_law else found
        # What metrics reckon with, such as home, is that of the arm itself.
        return replace(self, config=replace(config, arm=self.config.arm), whole=whole)

    def slope(self, parameter: Parameter) -> Setting:
        """Return the derivative by a parameter of what the run follows from.

        These numbers are polynomials of low degree in a parameter, as omega_n^2 is, or ratios of such: the formula of
        eighth order through values near the parameter's own is exact to rounding, and that of sixth order must agree.

        Raises:
            NotSmoothError: where they do not.
            ConfigError: where a value beside the parameter's own is not allowed.
        """
        base, h = self.setting, _PART * parameter.value
        scenes = {step: self.at(parameter, parameter.value + step * h) for step in (*range(-4, 0), *range(1, 5))}
        if any(_fixed(scene.whole) != _fixed(self.whole) for scene in scenes.values()):
            raise NotSmoothError(f"{parameter.name}: the code of the law itself changes with it")
        settings = {step: scene.setting for step, scene in scenes.items()}

        def derivative(of: Callable[[Setting], FloatArray]) -> FloatArray:
            taken = {step: of(setting) for step, setting in settings.items()}
            if any(value.shape != of(base).shape for value in taken.values()):
                raise NotSmoothError(f"{parameter.name}: the code of the law itself changes with it")
            finite = np.isfinite(of(base))  # a limit that is none stays none
            taken = {step: np.where(finite, value, 0.0) for step, value in taken.items()}
            found, other = (
                sum(weight * (taken[step] - taken[-step]) for step, weight in enumerate(weights, start=1)) / h
                for weights in (_EIGHTH, _SIXTH)
            )
            near = np.abs(np.where(finite, of(base), 0.0)) / abs(parameter.value)
            size = np.maximum(np.abs(found), near)
            # Where large numbers have cancelled, rounding is of their size.
            if not np.all(np.abs(found - other) <= _AGREES * size + _ROUNDING * near.max(initial=0.0)):
                raise NotSmoothError(f"{parameter.name}: the numbers of the loop are not smooth in it")
            exact: FloatArray = np.where(np.abs(found) <= _ROUNDING * size, 0.0, found)
            return exact

        return Setting(
            derivative(lambda setting: setting.numbers),
            derivative(lambda setting: setting.start),
            [derivative(lambda setting, n=number: setting.errors[n]) for number in range(len(base.errors))],  # type: ignore[misc]
        )


def _with_laws_of(whole: Whole, other: Whole) -> Whole:
    """Return another closed loop with the laws of a first one, which reckon with the other's arms."""
    loops = []
    for own, changed in zip(whole.commands.loops, other.commands.loops, strict=True):
        law = copy.copy(own.law)
        law.models = changed.law.models
        law.__dict__.pop("_arms", None)
        loops.append(replace(own, law=law))
    return replace(other, commands=replace(other.commands, loops=tuple(loops)))


def _fixed(whole: Whole) -> list[str]:
    return [fixed_text(loop.law) for loop in whole.commands.loops]
