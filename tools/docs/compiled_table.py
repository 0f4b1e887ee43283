"""Table of compiled laws and options for docs/reference.md, from assembled runs."""

from collections.abc import Iterator

from runner.assembly.assemble import assemble, assemble_program
from runner.assembly.validation import validate
from runner.config.compose.compose import compose
from tools.laws import LAWS

_CASES = {
    "encoders with noise, bias, steps, differenced velocity": (
        "noise=thesis",
        "noise.bias=1e-4",
        "noise.resolution=1e-5",
        "noise.velocity=finite_difference",
    ),
    "torque limits": ("torque_limits=thesis",),
    "a command delay": ("plant.computation.delay=2",),
    "several steps a tick": ("plant.step=0.005",),
    "friction of every kind": (
        "plant.friction.viscous=1",
        "plant.friction.coulomb=1",
        "plant.friction.asymmetry=0.5",
        "plant.friction.static=2",
        "plant.friction.stribeck_speed=0.1",
        "plant.friction.sigmoid.level=1",
        "plant.friction.sigmoid.steepness=10",
    ),
    "a payload": ("robot.payload.mass=0.5",),
    "a model error drawn for each repetition": ("mismatch.mass=1.1", "mismatch.spread=0.1"),
    "loops of several periods": (
        "robot=combined",
        "controller=macro_mini",
        "controller.period={macro: 0.01, mini: 0.001}",
    ),
    "stages with decoupled dynamics": ("robot=combined", "controller=whole_body", "plant.dynamics=decoupled"),
    "a push": ("environment=push",),
    "a hand": ("environment=hand_guiding",),
}
_HEAD = """\
Code is compiled for arms of up to 12 joints if llvmlite is installed. A *whole run* is machine code, and runs that
differ only in numbers advance together: repetitions, seeds, gains, limits, noise, masses, goals, durations. *The law*:
only the torques are machine code, in a Python loop. *Python*: nothing is compiled. Only the config determines this.
With installed metric plug-ins whole runs advance one by one. See also [compiled laws](plugins.md#a-compiled-law) and
[plants](plugins.md#plant).

"""
_BASE = ("robot=macro", "controller=operational_space", "trajectory=quintic")


def compiled_section() -> Iterator[str]:
    """Yield the section."""
    yield _HEAD
    engines = ("rk4", "bullet")
    yield f"| Controller | {' | '.join(f'`plant={engine}`' for engine in engines)} |\n|---|---|---|\n"
    for law in LAWS.values():
        cells = (_compiled(*law.overrides, f"plant={law.plant(engine)}") for engine in engines)
        yield f"| `{law.name}`{' with flexible joints' * law.flexible} | {' | '.join(cells)} |\n"
    yield "\n`operational_space` on `plant=rk4`, or the options of the line, with\n\n| | |\n|---|---|\n"
    for name, overrides in _CASES.items():
        own = {text.partition("=")[0]: text for text in (*_BASE, "plant=rk4", *overrides)}
        yield f"| {name} | {_compiled(*own.values())} |\n"
    yield "\n"


def _compiled(*overrides: str) -> str:
    config = validate(compose(overrides))
    if assemble_program(config) is not None:
        return "whole run"
    closed = assemble(config)
    closed.close()
    return "Python" if closed.compiled is None else "the law"
