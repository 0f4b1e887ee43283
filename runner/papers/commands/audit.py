"""Compare your formulas with a robot's kinematics and dynamics.

A FILE of formulas is YAML: `elements` holds the expression of each element (J_11 to J_6n, linear rows first; P_x, P_y,
P_z; M_11 to M_nn; G_1 to G_n), in SI units and the base frame. Expressions may use q1, s1 = sin(q1), c1 = cos(q1) and
so on, and the names in `symbols`.

Example: runner audit xarm7 --tip link7 --jacobian jacobian.yaml
"""

import math
from argparse import Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from runner.base.errors import RunnerError
from runner.cli.arguments import Parser
from runner.reporting.table import Cell, Number, Table, numbers, terminal

if TYPE_CHECKING:
    from runner.papers.audit.own_formulas import FormulaDifference

_MOST = 100_000


def add_arguments(parser: Parser) -> None:
    """Add the arguments."""
    parser.add_argument("urdf", metavar="URDF", help="a file, or a built-in robot such as xarm7")
    parser.add_argument("--tip", required=True, metavar="FRAME", help="link whose origin is the tip")
    for name, words in (
        ("position", "the tip's position [m]"),
        ("jacobian", "the tip's Jacobian [m/rad and 1]"),
        ("mass-matrix", "the mass matrix [kg m^2]"),
        ("gravity", "the gravity torques [N m]"),
    ):
        parser.add_argument(f"--{name}", type=Path, metavar="FILE", help=f"formulas of {words}")
    parser.add_argument(
        "--samples", metavar="N", type=int, default=1000, help="number of random configurations (default: %(default)s)"
    )
    parser.add_argument(
        "--tolerance",
        metavar="X",
        type=float,
        default=1e-6,
        help="largest difference that counts as equal, in SI units (default: %(default)s)",
    )


def run(options: Namespace) -> int:
    """Compare the formulas of the files given; return 1 if one of them differs."""
    from runner.papers.audit.model_derivations import audited_arm
    from runner.papers.audit.own_formulas import QUANTITIES, compare

    files = {name: getattr(options, name.replace("-", "_")) for name in QUANTITIES}
    given = {name: path for name, path in files.items() if path is not None}
    if not given:
        raise RunnerError(f"no formulas to compare. Add one of {', '.join('--' + name for name in QUANTITIES)}.")
    if not 1 <= options.samples <= _MOST:
        raise RunnerError(f"--samples: out of range ({options.samples}). Allowed: 1 to {_MOST}.")
    if not 0 < options.tolerance < math.inf:
        raise RunnerError(f"--tolerance: out of range ({options.tolerance:g}). Allowed: above 0.")
    urdf = str(Path(options.urdf).resolve()) if Path(options.urdf).is_file() else options.urdf
    model = audited_arm(urdf, options.tip, (), Path()).model
    differ = 0
    for name, path in given.items():
        differ += _report(name, compare(model, name, path, options.samples), options.tolerance)
    return 1 if differ else 0


def _report(quantity: str, differences: "list[FormulaDifference]", tolerance: float) -> int:
    """Print the comparison of one file; return the number of formulas that differ."""
    wrong = [each for each in differences if each.largest > tolerance]
    print(f"{quantity}: {len(differences) - len(wrong)} of {len(differences)} formulas agree")
    if wrong:
        rows: list[list[Cell]] = []
        for each in wrong:
            at = " ".join(f"{angle:.3f}" for angle in each.at)
            hint = f"it is the true {each.instead}" if each.instead else ""
            rows.append([each.element, *map(Number, (each.largest, each.typical, each.found, each.true)), at, hint])
        header = ["element", *numbers("largest error", "typical", "formula gives", "true"), "at q [rad]", ""]
        print(terminal(Table("", header, rows)))
    return len(wrong)
