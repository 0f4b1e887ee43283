"""Controllers of the combined arm as executed, and its metrics compared with those of the Macro."""

from dataclasses import replace

from runner.reporting.document import Curves, Panel, Picture, Series
from runner.reporting.figures import origin, rows_until
from runner.reporting.words import PRESET
from runner.store import Run
from runner.studies.thesis.diagrams.block_diagram import block_diagram
from runner.studies.thesis.diagrams.control_steps import control_steps
from runner.studies.thesis.diagrams.macro_mini import macro_mini_graph
from runner.studies.thesis.diagrams.whole_body import whole_body_graph
from runner.studies.thesis.folding import singular_value
from runner.study.results import Runs

_OF_COUPLED_LAWS = (
    *("coupling", "macro_target", "mini_reference_velocity", "wrist_rotation", "gravity_compensation", "feedforward"),
    *("schedule", "beyond_reach"),
)

_WHOLE_BODY = (
    "Block diagram of one controller for the whole arm: the tip's target and all measured joints go in, the torques of "
    "Macro and Mini come out"
)
_DOES = {
    "independent": "each follows a separate target; the Mini keeps its offset at home, which turns with the wrist",
    "independent_base": "each follows a separate target; the Mini keeps its offset at home in the base frame, for "
    "which it reads the Macro's wrist",
    "one_way": "the Mini's target is what is left of the way from the Macro's measured end point to the desired tip",
    "two_way": "the Mini's target is what is left of the way from the Macro's measured end point to the desired tip, "
    "and the Macro's target moves with the Mini's measured posture",
    "mini_held": "the Macro follows the tip's target, the Mini's joints are held at home",
}


def whole_body_law(runs: Runs, run: str, caption: str, number: str) -> Picture:
    """Return the block diagram of the law for the whole arm that a run executed."""
    controller = runs[run].config["controller"]
    graph = whole_body_graph(
        controller["gravity_compensation"],
        controller["feedforward"],
        torque_limited=True,
        goal=False,
        speed_limited=controller["max_tip_speed"] is not None,
        posture_task=controller["null_space_frequency"] > 0.0,
    )
    return Picture(caption, block_diagram(graph), _WHOLE_BODY, 0.68, origin(runs[run], number))


def coupled_laws(runs: Runs, run: str, caption: str, number: str = "") -> Picture:
    """Return the block diagram of the two laws that a run executed."""
    config = runs[run].config
    controller = config["controller"]
    graph = macro_mini_graph(
        **{key: controller[key] for key in _OF_COUPLED_LAWS},
        torque_limited=config["torque_limits"]["max"] is not None,
        goal=config["trajectory"]["kind"] == "goal",
    )
    does = _DOES[controller["coupling"]]
    limited = "with" if config["torque_limits"]["max"] is not None else "without"
    words = f"Block diagram of two control loops, Macro and Mini, {limited} torque limits: {does}"
    return Picture(caption, block_diagram(graph), words, 0.68, origin(runs[run], number))


def steps(runs: Runs, run: str, caption: str, number: str) -> Picture:
    """Return the flow chart of the control steps of method 3."""
    drawing = control_steps("both", "hold")
    return Picture(caption, drawing, "Flow chart of the control steps", 0.45, origin(runs[run], number))


def shares(runs: Runs, caption: str, number: str, *names: str) -> Curves:
    """Return curves of the ways of Macro and Mini to the desired tip, in x direction, a row for each run."""
    figures = [macro_mini_targets(runs[name], number, caption) for name in names]
    return replace(figures[0], panels=[panel for figure in figures for panel in figure.panels])


def unfolded(run: Run) -> float:
    """Return the smallest singular value of the Mini's Jacobian at the start of a run, at home, in m."""
    return float(singular_value(run)[0])


def folded(run: Run) -> float:
    """Return the largest such value over the last half second, in m."""
    return float(singular_value(run)[run.t >= run.t[-1] - 0.5].max())


def spreads(runs: Runs, title: str, name: str, *metrics: str) -> list[str]:
    """Return the metrics of an experiment under each preset behind its title, as a row of a table."""
    return [title, *(runs[f"{name}/{preset}"].metrics[metric].text for preset in PRESET for metric in metrics)]


def macro_mini_targets(
    run: Run, number: str = "", caption: str = "", until: float | None = None, axis: str = "x"
) -> Curves:
    """Return curves of the ways of Macro and Mini to the desired tip, along one axis.

    Args:
        run: A run of a robot with two stages.
        number: Number of the figure in the source.
        caption: What is seen; "" takes the default sentence.
        until: End of the time axis, in s; None shows the whole run.
        axis: The axis of the base frame: x, y or z.
    """
    rows = rows_until(run, until)
    t = run.t[rows]
    macro, mini = list(run.provenance["stages"])[:2]
    desired, tip, end_point = (run.signal(f"{stem}_{axis}")[rows] for stem in ("desired", "tip", f"{macro}_tip"))
    big, small = macro.capitalize(), mini.capitalize()
    positions = (
        Series("tip", t, tip, color=0),
        Series(f"{big} end point", t, end_point, color=1),
        Series("desired tip", t, desired, "dashed", color=7),
    )
    shares = (
        Series(f"tip less {big} end point", t, tip - end_point, color=0),
        Series(f"desired tip less {big} end point", t, desired - end_point, "dashed", color=7),
    )
    panels = (
        Panel(f"Positions in {axis} direction", "time (s)", f"{axis} (m)", positions),
        Panel(f"The {small}'s share of them", "time (s)", f"{axis} (m)", shares),
    )
    caption = caption or f"Ways of {big} and {small} to the desired tip, in {axis} direction."
    return Curves(caption, panels, origin=origin(run, number))
