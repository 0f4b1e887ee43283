"""Chapter 5: control of the combined Macro-Mini."""

from collections.abc import Mapping

from runner.controllers.macro_mini_graph import macro_mini_graph
from runner.controllers.whole_body_graph import whole_body_graph
from runner.reporting.document import Block, Formula, Picture, Section, Table, Text
from runner.reporting.drawings import block_diagram, control_steps, frame_assignment
from runner.reporting.figures import desired_motion, model_of, origin, playback
from runner.reporting.figures_staged import macro_mini_targets, staged_torque_and_error
from runner.reporting.job import PRESETS
from runner.reporting.quantities import spread
from runner.reporting.run_values import cell
from runner.reporting.words import PRESET
from runner.robots.denavit_hartenberg import denavit_hartenberg
from runner.store import Run
from runner.works.thesis.arm import dh_cells, reproduced

_SHARE = "How Macro and Mini share the way to the desired tip, in x direction."
_GOAL_METRICS = ("settling_time", "steady_state_error", "overshoot", "reach_loss_fraction", "saturation_fraction")
_TRACKING_METRICS = (
    "max_tracking_error",
    "rms_tracking_error",
    "steady_state_error",
    "macro_max_tracking_error",
    "macro_steady_state_error",
    "reach_loss_fraction",
)


def chapter5(runs: Mapping[str, Run]) -> Section:
    """Return figures 5.1 to 5.13 and table 5.1."""
    return Section(
        "Chapter 5: the combined Macro-Mini",
        sections=(
            _structure(runs["figure_5_8/sound"]),
            _control(runs),
            Section(
                "Goal position, one-way coupling",
                (
                    _graph(
                        runs["figure_5_8/sound"], "5.7", "One-way coupling: the Mini follows what the Macro misses."
                    ),
                    *_reproduced(runs, "5.8", "Macro-Mini, goal position, one-way coupling", _GOAL_METRICS),
                    playback(runs["figure_5_8/sound"], "Macro-Mini, goal position, one-way, full equations.", 2.0),
                ),
            ),
            Section(
                "Goal position, two-way coupling",
                (
                    _graph(
                        runs["figure_5_10/sound"], "5.9", "Two-way coupling: the Macro's target moves with the Mini."
                    ),
                    *_reproduced(runs, "5.10", "Macro-Mini, goal position, two-way coupling", _GOAL_METRICS),
                ),
            ),
            Section(
                "Trajectory tracking, one-way coupling",
                (
                    desired_motion(runs["figure_5_11/sound"], "Desired trajectory of the tip.", "figure 5.11"),
                    *_reproduced(runs, "5.12", "Macro-Mini, tracking, one-way coupling", _TRACKING_METRICS),
                    playback(runs["figure_5_12/sound"], "Macro-Mini, tracking, one-way, full equations.", 3.0),
                ),
            ),
            Section(
                "Trajectory tracking, two-way coupling",
                (*_reproduced(runs, "5.13", "Macro-Mini, tracking, two-way coupling", _TRACKING_METRICS),),
            ),
            Section("Summary", (_summary(runs),)),
        ),
    )


def _structure(run: Run) -> Section:
    model = model_of(run)
    rows = [dh_cells(index, row) for index, row in enumerate(denavit_hartenberg(model), start=1)]
    return Section(
        "Structure and modelling",
        (
            Picture(
                "Frames of the combined arm at the home position, drawn from the model.",
                frame_assignment(model, 0, "6"),
                "The combined arm at home with its joint axes and Denavit-Hartenberg frames",
                0.8,
                origin(run, "figure 5.1"),
            ),
            Table(
                "Denavit-Hartenberg parameters of the combined arm. The thesis' table is lost in the text that is "
                "left of it; this one is computed from the model, and the model's torques equal the thesis' "
                "appendix at its check values.",
                ["link", "$theta_i$ (rad)", "$d_i$ (m)", "$a_i$ (m)", "$alpha_i$ (rad)"],
                rows,
                (),
                origin(run, "table 5.1"),
            ),
            Text(
                "Joint 4 lies along link 3, as the appendix's gravity terms say. Chaining tables 3.1 and 4.1 as "
                "they stand would put the Mini's base elsewhere, with the tip up to 0.34 m off."
            ),
        ),
    )


def _control(runs: Mapping[str, Run]) -> Section:
    whole = runs["whole_body/quintic/whole body, 1 ms"]
    independent, fixed = runs["figure_5_3/sound"], runs["independent_base/sound"]
    controller = whole.config["controller"]
    graph = whole_body_graph(
        controller["gravity_compensation"],
        controller["feedforward"],
        torque_limited=True,
        goal=False,
        speed_limited=controller["max_tip_speed"] is not None,
        posture_task=controller["null_space_frequency"] > 0.0,
    )
    return Section(
        "Control structure",
        (
            Text(
                "Method 1 treats the arm as one, with the dynamics of the whole. The thesis calls it too slow to "
                "compute. Its runs here keep the default damping near singular postures, a share of "
                f"{controller['singularity_damping']:g} of the tip's error; all other figures have none."
            ),
            Formula(
                "tau = h + J^T Lambda (F^* - dot(J) dot(q)) + N^T tau_0, quad Lambda = (J M^(-1) J^T)^(-1)",
                "tau equals h plus J transposed Lambda times F star minus J-dot q-dot, plus the null-space torque",
            ),
            Formula(
                "tau_0 = - k_(v n) M dot(q) - K (q - q_r)",
                "the null-space torque damps all joints and draws the Mini's joints to their rest",
            ),
            Picture(
                "Method 1: one controller for the whole arm.",
                block_diagram(graph),
                "Block diagram of whole-body control",
                1.0,
                origin(whole, "figure 5.2"),
            ),
            Text(
                "Method 2 controls the arms independently: the Macro goes to $x_d - r_0$, the Mini keeps its offset "
                "$r_0$. The thesis' words allow two frames for it. In the Mini's own frame the offset turns with the "
                f"wrist, and the tip misses by {_errors(independent)}. Fixed in the base frame, in which the Mini is "
                f"sent to $R^T r_0$, it misses by {_errors(fixed)}, the Macro's end point by "
                f"{_errors(fixed, 'macro_')}. Both are shown, one run each, preset sound; with preset as_reported the "
                "wrist is taken not to turn, and there is one frame."
            ),
            macro_mini_targets(independent, "figure 5.3", f"{_SHARE} Offset turning with the wrist."),
            macro_mini_targets(fixed, "", f"{_SHARE} Offset fixed in the base frame."),
            _graph(independent, "5.4", "Method 2: independent controllers, the Mini's offset turning with the wrist."),
            _graph(fixed, "", "Method 2: independent controllers, the Mini's offset fixed in the base frame."),
            Text(
                "Method 3 keeps both controllers and gives the Mini the rest of the way, $R^T (x_d - x_E)$, while "
                "it is in reach."
            ),
            _graph(runs["figure_5_12/sound"], "5.5", "Method 3: an overall strategy on top of the two controllers."),
            Picture(
                "Control steps of method 3.",
                control_steps("both", "hold"),
                "Flow chart of the control steps",
                0.6,
                origin(runs["figure_5_12/sound"], "figure 5.6"),
            ),
        ),
    )


def _graph(run: Run, number: str, caption: str) -> Picture:
    controller = run.config["controller"]
    graph = macro_mini_graph(
        controller["coupling"],
        controller["macro_target"],
        controller["mini_reference_velocity"],
        controller["wrist_rotation"],
        controller["gravity_compensation"],
        controller["feedforward"],
        run.config["torque_limits"]["max"] is not None,
        run.config["trajectory"]["kind"] == "goal",
        controller["schedule"],
        controller["beyond_reach"],
    )
    text = f"{caption} Drawn from the graph of the controller that ran (full equations)."
    return Picture(
        text,
        block_diagram(graph),
        "Block diagram of the two coupled control loops",
        1.0,
        origin(run, f"figure {number}" if number else ""),
    )


def _errors(run: Run, stage: str = "") -> str:
    """Return the largest error of an end point while it moves, and that at rest."""
    moving, still = (cell(run, f"{stage}{metric}") for metric in ("max_tracking_error", "steady_state_error"))
    return f"{moving} m at most and {still} m at rest"


def _reproduced(runs: Mapping[str, Run], number: str, what: str, metrics: tuple[str, ...]) -> list[Block]:
    return reproduced(runs, number, what, metrics, draw=staged_torque_and_error)


def _summary(runs: Mapping[str, Run]) -> Table:
    kinds = (
        ("Macro alone, goal", "macro_alone_goal", "macro_settling_time", "macro_steady_state_error"),
        ("one-way, goal", "figure_5_8", "settling_time", "steady_state_error"),
        ("two-way, goal", "figure_5_10", "settling_time", "steady_state_error"),
        ("Macro alone, tracking", "macro_alone", "macro_max_tracking_error", "macro_steady_state_error"),
        ("one-way, tracking", "figure_5_12", "max_tracking_error", "steady_state_error"),
        ("two-way, tracking", "figure_5_13", "max_tracking_error", "steady_state_error"),
    )
    rows = [
        [title, *(spread(runs[f"{name}/{preset}"].metrics[metric]) for preset in PRESETS for metric in metrics)]
        for title, name, *metrics in kinds
    ]
    header = [
        "arm and task",
        *(f"{what}, {name}" for name in PRESET.values() for what in ("settling or largest error", "at rest")),
    ]
    return Table(
        "Settling time (goal) or largest tracking error, and steady-state error, of every arm.",
        header,
        rows,
        (1, 2, 3, 4),
        origin(runs["figure_5_12/sound"]),
    )
