"""The combined arm's laws as they ran, and its numbers beside those of the Macro alone."""

from collections.abc import Mapping

from runner.controllers.macro_mini_graph import macro_mini_graph
from runner.controllers.whole_body_graph import whole_body_graph
from runner.drawing import block_diagram, control_steps
from runner.quantities import spread
from runner.reporting.document import Curves, Picture
from runner.reporting.figures import origin
from runner.reporting.figures_staged import macro_mini_targets
from runner.reporting.job import PRESETS
from runner.store import Run

_OF_COUPLED_LAWS = (
    *("coupling", "macro_target", "mini_reference_velocity", "wrist_rotation", "gravity_compensation", "feedforward"),
    *("schedule", "beyond_reach"),
)


def whole_body_law(runs: Mapping[str, Run], run: str, caption: str, number: str) -> Picture:
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
    return Picture(caption, block_diagram(graph), "Block diagram of whole-body control", 1.0, origin(runs[run], number))


def coupled_laws(runs: Mapping[str, Run], run: str, caption: str, number: str = "") -> Picture:
    """Return the block diagram of the two laws that a run executed."""
    config = runs[run].config
    controller = config["controller"]
    graph = macro_mini_graph(
        **{key: controller[key] for key in _OF_COUPLED_LAWS},
        torque_limited=config["torque_limits"]["max"] is not None,
        goal=config["trajectory"]["kind"] == "goal",
    )
    words = "Block diagram of the two coupled control loops"
    return Picture(caption, block_diagram(graph), words, 1.0, origin(runs[run], number))


def steps(runs: Mapping[str, Run], run: str, caption: str, number: str) -> Picture:
    """Return the flow chart of the control steps of method 3."""
    drawing = control_steps("both", "hold")
    return Picture(caption, drawing, "Flow chart of the control steps", 0.6, origin(runs[run], number))


def shares(runs: Mapping[str, Run], run: str, caption: str, number: str = "") -> Curves:
    """Return how Macro and Mini share the way to the desired tip, in x direction."""
    return macro_mini_targets(runs[run], number, caption)


def spreads(runs: Mapping[str, Run], title: str, name: str, *metrics: str) -> list[str]:
    """Return the metrics of an experiment under each preset behind its title, as a row of a table."""
    return [title, *(spread(runs[f"{name}/{preset}"].metrics[metric]) for preset in PRESETS for metric in metrics)]
