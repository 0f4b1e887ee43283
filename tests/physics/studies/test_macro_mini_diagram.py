"""Block diagram of Macro and Mini: couplings and terms by option, and each controller's inputs by both."""

import itertools
from types import SimpleNamespace

import numpy as np
import pytest
from support.covers import every_case, name_of, pairwise
from support.graph_layout import assert_loop_closed, check_structure, check_texts, check_ways

from runner.controllers import CONTROLLERS
from runner.robots.robot import StageBase
from runner.studies.thesis.diagrams.macro_mini import macro_mini_graph

CHOICES = {
    "coupling": ("independent", "one_way", "two_way", "mini_held", "independent_base"),
    "macro_target": ("minus_home", "tip_goal"),
    "mini_reference_velocity": ("full", "zero"),
    "wrist_rotation": ("real", "parallel"),
    "gravity_compensation": (True, False),
    "feedforward": (True, False),
    "torque_limited": (True, False),
    "goal": (False, True),
    "schedule": ("both", "turns"),
    "beyond_reach": ("hold", "stretch"),
}
EVERY = every_case(CHOICES)
SAMPLE = [EVERY[index] for index in np.random.default_rng(0).choice(len(EVERY), 60, replace=False)]
FIGURES = [
    {**EVERY[0], "coupling": coupling, **more}
    for coupling in CHOICES["coupling"]
    for more in ({}, {"schedule": "turns"}, {"schedule": "turns", "beyond_reach": "stretch", "goal": True})
]


def sources_of(graph, name):
    """Names of all nodes from which a signal reaches a node through controllers, not through the arms."""
    reached, frontier = set(), {name}
    while frontier:
        frontier = {e.source for e in graph.edges if e.target in frontier and "_arm" not in e.source} - reached
        reached |= frontier
    return reached


def macro_side(graph):
    """Return the inputs of the Macro's controller except for its own measurement."""
    edges = [edge for edge in graph.edges if edge.target == "macro_controller" and edge.leave == "right"]
    return {name for edge in edges for name in {edge.source} | sources_of(graph, edge.source)}


def mini_target(graph):
    (edge,) = [edge for edge in graph.edges if edge.target == "mini_controller" and edge.leave == "right"]
    return {edge.source} | sources_of(graph, edge.source)


@pytest.mark.parametrize("coupling", CHOICES["coupling"])
def test_signals_between_the_arms_follow_the_coupling(coupling):
    for flags in EVERY:
        if flags["coupling"] != coupling:
            continue
        graph = macro_mini_graph(**flags)
        assert ("mini_encoders" in macro_side(graph)) == (coupling == "two_way")
        assert ("home_offset" in macro_side(graph)) == (
            coupling != "two_way" and not (coupling == "one_way" and flags["macro_target"] == "tip_goal")
        )
        follows = coupling in ("one_way", "two_way")
        turned = coupling == "independent_base" and flags["wrist_rotation"] == "real"
        assert ("macro_encoders" in mini_target(graph)) == (follows or turned)
        assert ("reference" in mini_target(graph)) == follows
        assert "reference" in macro_side(graph)


def test_terms_follow_their_switches():
    for flags in EVERY:
        graph = macro_mini_graph(**flags)
        names = {node.name: node for node in graph.nodes}
        follows, real = flags["coupling"] in ("one_way", "two_way"), flags["wrist_rotation"] == "real"
        assert ("gravity" in names) == flags["gravity_compensation"]
        if "gravity" in names:
            assert ("macro_encoders" in sources_of(graph, "gravity")) == real
        assert ({"macro_limit", "mini_limit"} <= set(names)) == flags["torque_limited"]
        assert ("macro_turn" in names) == (flags["schedule"] == "turns")
        assert ("reach" in names) == follows
        if follows:
            assert ("stretch" in names["reach"].label) == (flags["beyond_reach"] == "stretch")
            assert ("Own turn" in names["reach"].label) == (flags["schedule"] == "turns")
            assert (r"\dot{r}" in names["mini_target"].label) == (flags["mini_reference_velocity"] == "full")
        given = " ".join(edge.label for edge in graph.edges if edge.source == "reference")
        assert (r"\ddot" in given) == (flags["feedforward"] and not flags["goal"])
        assert ("x_g" in given) == flags["goal"]
        assert all("R_0" not in node.label for node in graph.nodes) or not real


def test_both_loops_are_closed():
    for flags in FIGURES:
        graph = macro_mini_graph(**flags)
        for stage in ("macro", "mini"):
            assert_loop_closed(graph, f"{stage}_arm")


class Recorder:
    """Stands in for a stage's law and notes what it receives."""

    def move(self, arm, numbers, q, dq, reference, gravity=None):
        self.told, self.gravity = ("move", reference.copy()), gravity
        return np.zeros(3)

    def hold(self, arm, numbers, q, dq, posture, gravity=None):
        self.told, self.gravity = ("hold", posture.copy()), gravity
        return np.zeros(3)


@pytest.fixture(scope="module")
def riding(checked_config):
    return checked_config("robot=combined")


def told_by_graph(graph, config, time, q, dq, reference):
    """Follow the graph's signals up to both controllers: what each receives, and gravity as the Mini sees it."""
    robot, names = config.arm, {node.name: node.label for node in graph.nodes}
    base = StageBase(robot, 1, config.controller.wrist_rotation == "parallel")
    base.update(q, dq)
    R, (velocity, spin) = base.rotation, base.velocity()
    r = reference[0] - base.position
    within, mini_turn = np.linalg.norm(r) <= config.controller.reach, int(time / 0.01 + 1e-9) % 2 == 1
    target = reference.copy()
    for edge in graph.edges:
        if edge.target == "macro_target" and edge.sign == "-":
            offset = R @ robot.stages[1].model.tip_position(q[3:]) if edge.source == "mini_offset" else [0, 0.1, 0.1]
            target[0] -= offset
    macro = ("hold", q[:3]) if "macro_turn" in names and mini_turn and within else ("move", target)
    aim = np.zeros((3, 3))
    if "reach" not in names:
        aim[0] = [0.0, 0.1, 0.1]
        if "R^T r_0" in names["mini_target"]:
            if r"\omega" in names["mini_target"]:
                aim[1] = -R.T @ np.cross(spin, aim[0])
            aim[0] = R.T @ aim[0]
        mini = ("hold", np.zeros(3)) if "configuration" in names["mini_target"] else ("move", aim)
    elif ("Own turn" in names["reach"] and not mini_turn) or (not within and "else stretch" not in names["reach"]):
        mini = ("hold", q[3:])
    else:
        aim[0] = R.T @ r
        if not within:
            aim[0] *= config.controller.reach / np.linalg.norm(r)
        elif r"\dot{r}" in names["mini_target"]:
            aim[1] = R.T @ (reference[1] - velocity - np.cross(spin, r))
        mini = ("move", aim)
    return macro, mini, R.T @ robot.model.gravity


def assert_told_alike(riding, flags, generator):
    keys = ("coupling", "macro_target", "mini_reference_velocity", "wrist_rotation", "gravity_compensation",
            "feedforward", "schedule", "beyond_reach")  # fmt: skip
    controller = riding.controller.model_copy(update={key: flags[key] for key in keys})
    loops = CONTROLLERS.build(controller, riding.arm)
    config = SimpleNamespace(arm=riding.arm, controller=controller)
    graph = macro_mini_graph(**flags)
    for time, near in itertools.product((0.0, 0.013), (0.05, 0.4)):
        q, dq = generator.uniform(-1.0, 1.0, (2, 6))
        base = StageBase(riding.arm, 1, flags["wrist_rotation"] == "parallel")
        base.update(q, dq)
        direction = generator.normal(size=3)
        reference = generator.uniform(-1.0, 1.0, (3, 3))
        reference[0] = base.position + near * direction / np.linalg.norm(direction)
        if flags["goal"]:
            reference[1:] = 0.0
        *expected, gravity = told_by_graph(graph, config, time, q, dq, reference)
        for loop, (action, what) in zip(loops, expected, strict=True):
            loop.controller.reset()
            loop.controller._law = law = Recorder()
            loop.controller.torque(time, q, dq, reference)
            assert law.told[0] == action, flags
            np.testing.assert_allclose(law.told[1], what, atol=1e-12, err_msg=str(flags))
        np.testing.assert_allclose(law.gravity, gravity, atol=1e-12, err_msg=str(flags))


def test_the_graph_is_what_is_executed(riding):
    for number, flags in enumerate([*SAMPLE, *pairwise(CHOICES)]):
        assert_told_alike(riding, flags, np.random.default_rng(number))


@pytest.mark.slow
def test_every_graph_is_what_is_executed(riding):
    """All cases; each session takes a sample and a pairwise cover."""
    for number, flags in enumerate(EVERY):
        assert_told_alike(riding, flags, np.random.default_rng(number))


@pytest.mark.parametrize("flags", [*FIGURES, *pairwise(CHOICES)], ids=name_of)
def test_the_picture_keeps_the_rules(flags):
    graph = macro_mini_graph(**flags)
    check_structure(graph)
    check_ways(graph)


@pytest.mark.slow
def test_every_picture_keeps_the_rules():
    """All cases; each session takes the figures and a pairwise cover."""
    for flags in EVERY:
        graph = macro_mini_graph(**flags)
        check_structure(graph)
        check_ways(graph)


@pytest.mark.parametrize(
    "flags",
    [
        pytest.param(flags, id=name_of(flags), marks=() if flags["goal"] else pytest.mark.slow) for flags in FIGURES
    ],  # those to a goal have the most strings; drawing takes time
)
def test_no_text_of_the_picture_stands_on_a_line(flags):
    check_texts(macro_mini_graph(**flags))
