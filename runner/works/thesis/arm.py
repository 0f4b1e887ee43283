"""What chapters 3 and 4 share: kinematics, dynamics and control of one arm."""

import math
from collections.abc import Callable, Mapping

import numpy as np

from runner.controllers.operational_space_graph import operational_space_graph
from runner.reporting.document import Block, Curves, Formula, Picture, Section, Table, Text
from runner.reporting.drawings import block_diagram, frame_assignment
from runner.reporting.figures import model_of, origin, torque_and_error
from runner.reporting.job import PRESETS
from runner.reporting.metric_titles import title
from runner.reporting.plant_agreement import describe_agreement
from runner.reporting.quantities import above_rounding, spread
from runner.reporting.words import PRESET
from runner.robots.closed_form import compare
from runner.robots.denavit_hartenberg import DenavitHartenbergRow, denavit_hartenberg
from runner.store import Run

_SAMPLES = 1000
_UNITS = {"M": "kg m²", "V": "N m", "G": "N m", "J": "m", "T": "m"}
_MEANINGS = {
    "M": "mass matrix, (3.17)",
    "V": "centrifugal and Coriolis torque, (3.19)",
    "G": "gravity torque, (3.24)",
    "J": "basic Jacobian, (3.5)",
    "T": "tip transform, (3.1)",
}


def kinematics(run: Run, figure: str, table: str, first: int, tip: str) -> Section:
    """Return frame assignment and D-H table of an arm.

    Args:
        run: A run of the arm.
        figure: Number of the frame drawing in the thesis.
        table: Number of the D-H table.
        first: Number of the arm's frame 0.
        tip: Name of the tip frame.
    """
    model = model_of(run)
    rows = [dh_cells(first + index, row) for index, row in enumerate(denavit_hartenberg(model), start=1)]
    return Section(
        "Kinematic model",
        (
            Picture(
                "Frames at the home position, drawn from the model.",
                frame_assignment(model, first, tip),
                "The arm at home with its joint axes and Denavit-Hartenberg frames",
                0.6,
                origin(run, figure),
            ),
            Table(
                "Denavit-Hartenberg parameters (standard convention), computed from the model's joint axes.",
                ["link", "$theta_i$ (rad)", "$d_i$ (m)", "$a_i$ (m)", "$alpha_i$ (rad)"],
                rows,
                (),
                origin(run, table),
            ),
        ),
    )


def dh_cells(link: int, row: DenavitHartenbergRow) -> list[str]:
    """Return the cells of one row of a Denavit-Hartenberg table, angles as multiples of pi."""
    turn = f"$q_{link}$" if row.theta == 0.0 else f"{_angle(row.theta)} + $q_{link}$"
    return [str(link), turn, f"{row.d:g}", f"{row.a:g}", _angle(row.alpha)]


def _angle(value: float) -> str:
    """Return an angle as a multiple of pi where it is one."""
    if value == 0.0:
        return "0"
    twelfths = round(12.0 * value / math.pi)
    if abs(12.0 * value / math.pi - twelfths) > 1e-9:
        return f"{value:.6g}"
    divisor = math.gcd(twelfths, 12)
    top, bottom = twelfths // divisor, 12 // divisor
    head = "$-pi" if top == -1 else "$pi" if top == 1 else f"${top} pi"
    return f"{head}$" if bottom == 1 else f"{head} slash {bottom}$"


def dynamics(run: Run, length: float, mass: float) -> Section:
    """Return how far the thesis' printed matrices and the model agree."""
    differences = compare(model_of(run), length, mass, _SAMPLES, np.random.default_rng(0))
    rows = [[f"${s}$", _MEANINGS[s], above_rounding(value, _UNITS[s])] for s, value in differences.items()]
    return Section(
        "Dynamic model",
        (
            Text("The equations of motion and the gravity vector in them are"),
            Formula(
                "M(q) dot.double(q) + V(q, dot(q)) + G(q) = tau",
                "M of q times q double-dot plus V plus G equals tau",
                "3.25",
            ),
            Formula("G(q) = vec(0, m g L (2 c_2 - s_23), - m g L s_23)", "gravity vector of the arm", "3.24"),
            Text(
                "The gravity vector is printed with $s_2$ and $s_2 s_3$ where $s_23 = sin(q_2 + q_3)$ is meant. With "
                "this repair all printed matrices equal the model (Pinocchio, built from the runner's own URDF) at "
                f"{_SAMPLES} random states to rounding:"
            ),
            Table(
                "Largest difference between the printed closed forms and the model.",
                ["symbol", "quantity", "largest difference"],
                rows,
                (2,),
                origin(run),
            ),
        ),
    )


def control_law(run: Run, goal: bool, figure: str) -> list[Block]:
    """Return equations and block diagram of the law that a run executed."""
    controller = run.config["controller"]
    limited = run.config["torque_limits"]["max"] is not None
    graph = operational_space_graph(controller["gravity_compensation"], controller["feedforward"], limited, goal)
    law = (
        Formula(
            "F^* = -k_v dot(x) - k_p (x - x_g)", "F star equals minus k v x-dot minus k p times x minus x g", "3.33"
        )
        if goal
        else Formula(
            "F^* = dot.double(x)_d - k_v (dot(x) - dot(x)_d) - k_p (x - x_d)",
            "F star equals desired acceleration minus k v velocity error minus k p position error",
            "3.40",
        )
    )
    return [
        Formula(
            "F = hat(Lambda)(x) F^* + hat(mu)(x, dot(x)) + hat(p)(x), quad tau = J^T F",
            "F equals Lambda F star plus mu plus p; tau equals J transposed F",
            "3.32",
        ),
        law,
        Picture(
            "Control structure, drawn from the graph of the controller that ran (full equations). As reported "
            "the term $hat(p)(x)$ is "
            f"absent{'' if goal else ' and so are the desired velocity and acceleration'}.",
            block_diagram(graph),
            "Block diagram of the controller, the arm and its encoders",
            1.0,
            origin(run, figure),
        ),
    ]


def reproduced(
    runs: Mapping[str, Run],
    number: str,
    what: str,
    metrics: tuple[str, ...],
    until: float | None = None,
    draw: Callable[[Run, str, str, float | None], Curves] = torque_and_error,
) -> list[Block]:
    """Return one published figure under both presets, its numbers, and the plants' agreement on it.

    Args:
        runs: The stored runs, by name.
        number: The figure's number, such as "3.5".
        what: What is simulated.
        metrics: The metrics in its table.
        until: End of the time axis, in s; None shows the whole run.
        draw: Lays the curves of a run out.
    """
    figure = f"figure_{number.replace('.', '_')}"
    blocks: list[Block] = [
        draw(runs[f"{figure}/{preset}"], f"{what}, {PRESET[preset]}, repetition 0 of 40.", f"figure {number}", until)
        for preset in PRESETS
    ]
    rows = [[title(m), *(spread(runs[f"{figure}/{preset}"].metrics[m]) for preset in PRESETS)] for m in metrics]
    blocks.append(
        Table(
            f"Numbers of figure {number}: median (smallest to largest) of 40 repetitions.",
            ["metric", *PRESET.values()],
            rows,
            (1, 2),
            origin(runs[f"{figure}/{PRESETS[0]}"]),
        )
    )
    sentences = [
        f"{PRESET[preset].capitalize()}: {describe_agreement(runs[f'{figure}/{preset}'])}" for preset in PRESETS
    ]
    blocks.append(Text(" ".join(sentences)))
    return blocks
