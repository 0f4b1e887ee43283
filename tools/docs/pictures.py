"""Draws the pictures of the docs into docs/pictures: `python -m tools.docs.pictures`.

The pairs are those of a sweep made here, so that the pictures show what the runner does.
"""

import tempfile
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import runner
from runner.papers.studies.thesis.diagrams.block_diagram import ControlGraph, Edge, Node, block_diagram, control_graph
from runner.reporting.charts import palette
from runner.reporting.charts.canvas import GREY, INK, drawing
from runner.reporting.charts.sheet import column
from runner.reporting.document import Playback
from runner.reporting.export.motion import write_motion
from runner.reporting.overlaid_runs import Level, overlaid
from tools.docs.friction_picture import friction
from tools.docs.robot_pictures import robots

FOLDER = Path(__file__).resolve().parents[2] / "docs" / "pictures"
CONTROLLERS = ["computed_torque", "passivity"]


def way_of_a_run() -> str:
    """Draw what a run goes through, from its config to a report."""
    names = ("YAML files,\ncommand line", "Checked\nconfig", "Closed loop", "Trace", "Metrics,\ncaveats", "Stored run")
    nodes = [Node(name, "block", 2.2 * place, 0.0, name) for place, name in enumerate(names)]
    nodes += [
        Node(name, "block", 13.4, row, name)
        for name, row in (("Report", -1.2), ("Table, figures", 0.0), ("Check, compare", 1.2))
    ]
    edges = [Edge(*pair) for pair in pairwise(names)]
    edges += [
        Edge("Stored run", "Report", leave="top", enter="left"),
        Edge("Stored run", "Table, figures"),
        Edge("Stored run", "Check, compare", leave="bottom", enter="left"),
    ]
    return block_diagram(ControlGraph(tuple(nodes), tuple(edges)))


def closed_loop() -> str:
    """Draw the parts of a closed loop, each a group of the config."""
    nodes = (
        Node("trajectory", "source", 0.0, 0.0, "Trajectory"),
        Node("controller", "block", 2.2, 0.0, "Controller"),
        Node("limits", "block", 4.6, 0.0, "Torque limits"),
        Node("plant", "block", 6.8, 0.0, "Plant"),
        Node("environment", "source", 6.8, -1.4, "Environment"),
        Node("encoders", "block", 6.8, 1.4, "Encoders"),
        Node("noise", "source", 9.0, 1.4, "Noise"),
        Node("mismatch", "source", 2.2, -1.4, "Mismatch"),
    )
    edges = (
        Edge("trajectory", "controller", "$x_d$"),
        Edge("mismatch", "controller", leave="bottom", enter="top"),
        Edge("controller", "limits", r"$\tau$"),
        Edge("limits", "plant"),
        Edge("environment", "plant", leave="bottom", enter="top"),
        Edge("plant", "encoders", leave="bottom", enter="top"),
        Edge("noise", "encoders", leave="left", enter="right"),
        Edge("encoders", "controller", r"$q,\dot{q}$ measured", leave="left", enter="bottom"),
    )
    return block_diagram(ControlGraph(nodes, edges))


@drawing
def ticks() -> Figure:
    """Draw a torque that is held for a control period of ten steps of the plant, in s."""
    period, steps = 0.01, 10
    figure = Figure(figsize=(5.5, 1.8))
    axes = figure.add_subplot()
    fine = np.linspace(0.0, 4.0 * period, 400)
    starts = period * np.arange(5)
    axes.plot(fine, np.cos(60.0 * fine), color=GREY, lw=1.0, label="law, if it ran all the time")
    axes.step(starts, np.cos(60.0 * starts), where="post", color=palette.LIGHT[0], lw=1.6, label="torque, held")
    axes.plot(starts, np.cos(60.0 * starts), "o", color=palette.LIGHT[0], ms=4, label="control tick")
    axes.plot(period / steps * np.arange(4 * steps + 1), np.full(4 * steps + 1, -1.25), "|", color=INK, ms=6)
    axes.annotate("steps of the plant", (0.0, -1.2), (0.0, -1.05))
    axes.set(xlabel="t (s)", ylabel="torque (N m)", xticks=starts, xlim=(-0.001, 0.064), ylim=(-1.45, 1.2))
    axes.legend(frameon=False, loc="upper right")
    return figure


@drawing
def pairs() -> Figure:
    """Draw the errors of two controllers on the same draws of noise and masses, in mm."""
    with tempfile.TemporaryDirectory() as folder:
        sweep = runner.sweep(
            "robot=planar",
            "plant=rk4",
            "trajectory=quintic",
            "noise=thesis",
            "mismatch=sampled",
            controller=CONTROLLERS,
            repetitions=8,
            outputs=folder,
            workers=0,
        )
        runs = [sweep.run(controller=name) for name in CONTROLLERS]
        errors = [1e3 * np.array(run.metrics["max_tracking_error"].values) for run in runs]
    figure = Figure(figsize=(3.4, 2.2))
    axes = figure.add_subplot()
    for pair in zip(*errors, strict=True):
        axes.plot([0, 1], pair, "o-", color=palette.LIGHT[0], lw=0.8, ms=3)
    labels = [name.replace("_", " ") for name in CONTROLLERS]
    axes.set(xticks=[0, 1], xticklabels=labels, xlim=(-0.3, 1.3), ylabel="largest tracking error (mm)")
    return figure


def operational_space() -> str:
    """Draw the control structure of `controller=operational_space`."""
    return block_diagram(control_graph("operational space"))


def motion(path: Path) -> None:
    """Write the motion of the README: a weak PD controller behind computed torque, on a circle."""
    with tempfile.TemporaryDirectory() as folder:
        own = {"computed torque": "computed_torque", "PD with low gains": "joint_pd"}
        runs = {
            name: runner.run(
                *(["controller.natural_frequency=6"] if law == "joint_pd" else []),
                robot="panda",
                plant="rk4",
                trajectory="circle",
                controller=law,
                outputs=folder,
            )
            for name, law in own.items()
        }
        levels = [Level(name, [run], look) for look, (name, run) in enumerate(runs.items())]
        (both,) = (block for block in overlaid(levels) if isinstance(block, Playback))
        write_motion(both, path, column(80.0))


PICTURES: dict[str, Callable[[], str]] = {
    "way_of_a_run": way_of_a_run,
    "closed_loop": closed_loop,
    "ticks": ticks,
    "pairs": pairs,
    "operational_space": operational_space,
    "robots": robots,
    "friction": friction,
}


def main() -> None:
    """Draw them all."""
    FOLDER.mkdir(exist_ok=True)
    for name, draw in PICTURES.items():
        (FOLDER / f"{name}.svg").write_text(draw(), encoding="utf-8")
        print(FOLDER / f"{name}.svg")
    motion(FOLDER / "motion.gif")
    print(FOLDER / "motion.gif")


if __name__ == "__main__":
    main()
