"""Compute the sensitivity of a run's metrics to its parameters, largest first.

The derivatives are exact, by forward differentiation of the compiled run. Parameters are each number of the config,
with the keys that take its value, and masses, armature and lengths of links. The start, the desired motion and the
control steps are fixed. A run on bullet or mujoco has the derivatives of the same run on rk4.

Example: runner sensitivity latest --parameters gains,masses
"""

from argparse import Namespace
from collections.abc import Iterator, Mapping
from math import isnan
from typing import TYPE_CHECKING

from runner.base import progress
from runner.base.quantities import plain_number
from runner.cli.arguments import NameList, Parser, StoredFolder
from runner.reporting.table import Cell, Number, Table, numbers, terminal

if TYPE_CHECKING:
    from runner.analysis import Sensitivity
    from runner.analysis.sensitivity import Differences
    from runner.store import Run

_SHOWN = (
    "rms_tracking_error", "max_tracking_error", "steady_state_error", "overshoot", "peak_torque", "peak_joint_force",
    "energy",
)  # fmt: skip
_AGREES, _SURE = 1e-6, 1e-7  # of a derivative: how far differences may be off, and how sure they must be to count
_GROUPS = (
    "gains", "masses", "armature", "lengths", "payload", "friction", "gravity", "limits", "noise", "mismatch", "others",
)  # fmt: skip


def add_arguments(parser: Parser) -> None:
    """Add the arguments."""
    parser.add_argument("folder", type=StoredFolder("run"), metavar="RUN", help="folder of a run, or latest")
    parser.add_shared(metrics="metrics (default: the main ones)")
    groups = f"groups of parameters: {', '.join(_GROUPS)} (default: all)"
    parser.add_argument("--parameters", type=NameList(_GROUPS), metavar="A,B", help=groups)
    parser.add_argument("--repetition", type=int, default=0, metavar="N", help="repetition (default: 0)")
    parser.add_argument(
        "--finite-differences", action="store_true", help="also compute central differences, to compare"
    )


def run(options: Namespace) -> int:
    """Print a table for each metric; return 1 if differences disagree."""
    from runner import store
    from runner.analysis import check_smooth, differences, of_run

    stored = store.open_run(options.folder)
    progress.begin("differentiating", unit="parameters")
    found = of_run(stored, options.parameters or _GROUPS, options.repetition)
    names = options.metrics or [name for name in _SHOWN if name in found.metrics]
    for name in names:
        check_smooth(name, found.metrics)
    compared = differences(found, names) if options.finite_differences else {}
    print(_about(stored, found))
    for name in names:
        print(f"\n{name}: {plain_number(found.metrics[name])} {_unit(name)}")
        print(terminal(_table(found, name, compared.get(name))))
    print(*_notes(found), sep="\n")
    return _compare(found, compared) if options.finite_differences else 0


def _about(run: "Run", found: "Sensitivity") -> str:
    config = found.scene.config
    text = f"{config.robot.name}, {config.controller.kind}, repetition {found.scene.repetition}"
    kind = run.config["plant"]["kind"]
    if kind != config.plant.kind:
        text += f": derivatives of the same run on rk4, because those of {kind} are not available; so are the metrics"
    return f"{text}\nheld: the start, the desired motion, the ticks"


def _notes(found: "Sensitivity") -> Iterator[str]:
    """Yield the lines on keys that follow a parameter, and on parameters that are not in the tables."""
    yield ""
    for parameter in found.parameters:
        if parameter.followers:
            yield f"{parameter.name} also changes {', '.join(parameter.followers)}"
    for reason, names in found.left_out.items():
        yield f"not in the tables: {', '.join(names)}: {reason}"


def _unit(name: str) -> str:
    from runner.plugins.metric_units import unit_of

    return unit_of(name) or "1"


def _table(found: "Sensitivity", name: str, compared: "Differences | None") -> Table:
    """Return a table with a row for each parameter, the most important first."""
    unit = _unit(name)
    header = ["parameter", *numbers("value"), "unit", *numbers("derivative"), "its unit", *numbers("elasticity")]
    if compared is not None:
        header += numbers("differences", "sure to", "gap")
    rows: list[list[Cell]] = []
    elasticities, derivatives = found.elasticities(name), found.derivatives[name]
    for place in found.ranked(name):
        parameter, elasticity, derivative = found.parameters[place], elasticities[place], derivatives[place]
        below = f"({parameter.unit})" if set(parameter.unit) & set(" /") else parameter.unit
        by = unit if below == "1" else f"{unit} / {below}"
        rows.append(
            [
                *(parameter.name, Number(parameter.value), parameter.unit, Number(derivative), by),
                Number(None if isnan(elasticity) else elasticity),
            ]
        )
        if compared is not None:
            doubt = _relative(compared.doubts[place], derivative)
            gap = _relative(compared.derivatives[place] - derivative, derivative)
            rows[-1] += [Number(compared.derivatives[place]), f"{doubt:.1g}", f"{gap:.1g}"]
    return Table("", header, rows)


def _relative(difference: float, derivative: float) -> float:
    return abs(difference / derivative) if derivative else float("inf") if difference else 0.0


def _compare(found: "Sensitivity", compared: "Mapping[str, Differences]") -> int:
    """Print the deviation of derivatives from finite differences; return 1 if it is too large."""
    gaps = [
        _relative(by.derivatives[place] - derivative, derivative)
        for name, by in compared.items()
        for place, derivative in enumerate(found.derivatives[name])
        if _relative(by.doubts[place], derivative) <= _SURE
    ]
    count = sum(len(by.derivatives) for by in compared.values())
    print(f"\n{len(gaps)} of {count} central differences are sure to {_SURE:g} of the derivative or better")
    if not gaps:
        return 0
    agrees = max(gaps) <= _AGREES
    print(f"largest gap among these: {max(gaps):.2g}, {'within' if agrees else 'above'} {_AGREES:g}")
    return 0 if agrees else 1
