"""Control structures of the thesis: signals followed through the graphs against the torques of the laws."""

from dataclasses import replace

import numpy as np
import pytest
from support.arms import tip_numbers
from support.covers import SWITCH, every_case
from support.graph_layout import assert_loop_closed, check_structure, check_texts, check_ways, joined

from runner.config.compose.compose import compose
from runner.controllers.operational_space.operational_space import OperationalSpace
from runner.controllers.operational_space.whole_body import WholeBody, WholeBodyConfig
from runner.papers.studies.thesis.diagrams.block_diagram import control_graph, describe

RUNS = {
    "figure 3.4": "figure_3_5", "figure 3.7": "figure_3_10", "figure 5.2": "whole_body", "figure 5.4": "figure_5_3",
    "figure 5.5": "figure_5_12", "figure 5.7": "figure_5_8", "figure 5.9": "figure_5_10",
}  # fmt: skip
TWO_ARMS = ("figure 5.4", "figure 5.5", "figure 5.7", "figure 5.9")
OMEGA, XI, OMEGA_N, LIMIT = 30.0, 0.8, 20.0, 40.0
REST = np.array([0.0, 0.0, 0.0, 0.1, -0.2, 0.3])
OPTIONS = dict.fromkeys(("gravity_compensation", "feedforward", "torque_limited", "goal"), SWITCH)


def options_of(figure):
    """Return the law's config, whether torques are limited, and whether the target is a goal, of a figure's run."""
    preset = () if figure == "figure 5.2" else ("preset=full_equations",)
    config = compose([f"experiment=thesis/{RUNS[figure]}", *preset]).resolved
    return config["controller"], config["torque_limits"]["max"] is not None, config["trajectory"]["kind"] == "goal"


def follow(graph, state, gains, reference, limits):
    """Return the value at the arm's input.

    Args:
        graph: The graph.
        state: Values of nodes that take the measured state only.
        gains: Matrix or number of each block that multiplies its input.
        reference: Desired position, velocity and acceleration, shape (3, n).
        limits: Function of each block that limits its input.
    """
    model_terms = {"mu", "p", "h", "dJ_dq", "k_vn"}

    def signal(edge):
        if edge.source == "reference":  # the label of an edge names its derivative
            return reference[edge.label.count("dot") and (2 if "ddot" in edge.label else 1)]
        return value(edge.source)

    def value(name):
        if name in state:
            return state[name]
        taps = model_terms | set(gains)
        inputs = [e for e in graph.edges if e.target == name and not (e.source == "encoders" and name in taps)]
        total = sum((-1.0 if edge.sign == "-" else 1.0) * signal(edge) for edge in inputs)
        if name in gains:
            return gains[name] @ total if np.ndim(gains[name]) else gains[name] * total
        return limits.get(name, lambda given: given)(total)

    return value("arm")


def one_arm(flags):
    """Return the graph of the operational-space law under options, from the parts of the figures."""
    graph = joined(
        "tip errors",
        "trajectory" if flags["feedforward"] and not flags["goal"] else "goal",
        "operational space",
        "limited arm" if flags["torque_limited"] else "unlimited arm",
    )
    edges = [edge for edge in graph.edges if flags["gravity_compensation"] or "p" not in (edge.source, edge.target)]
    return replace(graph, edges=tuple(edges))


def test_the_graph_of_one_arm_is_the_law_that_is_executed(macro):
    for flags in every_case(OPTIONS):
        law = OperationalSpace(macro, tip_numbers(OMEGA, XI, flags["gravity_compensation"], flags["feedforward"], 0.0))
        graph, generator = one_arm(flags), np.random.default_rng(0)
        for _ in range(20):
            q, dq = generator.uniform(-1.0, 1.0, (2, 3))
            reference = generator.uniform(-1.0, 1.0, (3, 3))
            if flags["goal"]:
                reference[1:] = 0.0
            tau = law.torque(0.0, q, dq, reference)
            if flags["torque_limited"]:
                tau = np.clip(tau, -LIMIT, LIMIT)
            J = macro.tip_jacobian(q)[:3]
            inverse = np.linalg.inv(J)
            Lambda = inverse.T @ macro.mass_matrix(q) @ inverse
            mu = inverse.T @ macro.coriolis_torque(q, dq) - Lambda @ macro.tip_bias_acceleration(q, dq)
            state = {"position": macro.tip_position(q), "velocity": J @ dq, "mu": mu,
                     "p": inverse.T @ macro.gravity_torque(q)}  # fmt: skip
            gains = {"k_p": OMEGA**2, "k_v": 2.0 * XI * OMEGA, "Lambda": Lambda, "J^T": J.T}
            drawn = follow(graph, state, gains, reference, {"limit": lambda given: np.clip(given, -LIMIT, LIMIT)})
            atol = 1e-8 * max(1.0, np.abs(tau).max())
            np.testing.assert_allclose(drawn, tau, rtol=1e-8, atol=atol, err_msg=str(flags))


@pytest.mark.parametrize("figure", ["figure 3.4", "figure 3.7"])
def test_the_figures_of_one_arm_have_the_options_of_their_runs(figure):
    law, limited, goal = options_of(figure)
    flags = {key: law[key] for key in ("gravity_compensation", "feedforward")}
    assert control_graph(figure) == one_arm(flags | {"torque_limited": limited, "goal": goal})
    assert ("a goal at rest" in describe(figure)) == goal
    assert ("with torque limits" in describe(figure)) == limited


@pytest.mark.parametrize("limit", [np.inf, LIMIT])
@pytest.mark.parametrize("feedforward", SWITCH)
def test_the_graph_of_the_whole_arm_is_the_law_that_is_executed(combined, limit, feedforward):
    config = WholeBodyConfig(
        kind="whole_body", natural_frequency=OMEGA, damping_ratio=XI, period=1e-3, singularity_damping=0.0,
        gravity_compensation=True, feedforward=feedforward, null_space_frequency=OMEGA_N, max_tip_speed=None,
    )  # fmt: skip
    model = combined.model
    law, generator = WholeBody(model, config, REST), np.random.default_rng(0)
    graph = joined("tip errors", "trajectory" if feedforward else "goal", "whole body")
    at_rest = model.tip_jacobian(REST)[:3]
    Z = np.vstack([-np.linalg.solve(at_rest[:, :3], at_rest[:, 3:]), np.eye(3)])  # the Mini moves, the tip does not
    K = np.zeros((6, 6))
    K[3:, 3:] = OMEGA_N**2 * Z.T @ model.mass_matrix(REST) @ Z
    for _ in range(5):
        q, dq = generator.uniform(-1.0, 1.0, (2, 6))
        reference = generator.uniform(-1.0, 1.0, (3, 3))
        J, M = model.tip_jacobian(q)[:3], model.mass_matrix(q)
        Lambda = np.linalg.inv(J @ np.linalg.inv(M) @ J.T)
        N = np.eye(6) - np.linalg.inv(M) @ J.T @ Lambda @ J
        state = {
            "position": model.tip_position(q),
            "velocity": J @ dq,
            "dJ_dq": model.tip_bias_acceleration(q, dq),
            "h": model.coriolis_torque(q, dq) + model.gravity_torque(q),
            "k_vn": 2.0 * OMEGA_N * M @ dq,
            "posture": REST,
            "encoders": q,  # what the posture's summing point takes of it
        }
        gains = {"k_p": OMEGA**2, "k_v": 2.0 * XI * OMEGA, "Lambda": Lambda, "J^T": J.T, "N^T": N.T, "K": K}
        tau = np.clip(law.torque(0.0, q, dq, reference), -limit, limit)
        drawn = follow(graph, state, gains, reference, {"limit": lambda given: np.clip(given, -limit, limit)})
        np.testing.assert_allclose(drawn, tau, rtol=1e-7, atol=1e-7 * max(1.0, np.abs(tau).max()))


def test_the_figure_of_the_whole_arm_has_the_options_of_its_run():
    law, limited, goal = options_of("figure 5.2")
    assert (law["gravity_compensation"], law["feedforward"], law["max_tip_speed"]) == (True, True, None)
    assert (law["null_space_frequency"] > 0.0, limited, goal) == (True, True, False)
    assert control_graph("figure 5.2") == joined("tip errors", "trajectory", "whole body")


def sources_of(graph, name):
    """Names of all nodes from which a signal reaches a node through controllers, not through the arms."""
    reached, frontier = set(), {name}
    while frontier:
        frontier = {e.source for e in graph.edges if e.target in frontier and "_arm" not in e.source} - reached
        reached |= frontier
    return reached


def target_of(graph, stage):
    """Return all nodes that the target of a controller depends on, except for its own measurement."""
    edges = [edge for edge in graph.edges if edge.target == f"{stage}_controller" and edge.leave == "right"]
    return {name for edge in edges for name in {edge.source} | sources_of(graph, edge.source)}


@pytest.mark.parametrize("figure", TWO_ARMS)
def test_signals_between_two_arms_follow_the_options_of_the_run(figure):
    (law, limited, goal), graph = options_of(figure), control_graph(figure)
    labels = {node.name: node.label for node in graph.nodes}
    follows = law["coupling"] in ("one_way", "two_way")
    assert (law["wrist_rotation"], law["macro_target"], law["schedule"]) == ("real", "minus_home", "both")
    assert (law["gravity_compensation"], law["feedforward"], limited) == (True, True, True)
    assert (law["mini_reference_velocity"], law["beyond_reach"]) == ("full", "hold")
    macro, mini = (target_of(graph, stage) for stage in ("macro", "mini"))
    assert ("mini_encoders" in macro) == (law["coupling"] == "two_way")
    assert ("home_offset" in macro) == (law["coupling"] != "two_way")
    assert ({"macro_encoders", "reference"} <= mini) == follows
    assert ("else hold" in labels.get("reach", "")) == follows
    assert (r"\dot{r} - \omega \times r" in labels["mini_target"]) == follows
    given = " ".join(edge.label for edge in graph.edges if edge.source == "reference")
    assert ("x_g" in given, r"\ddot" in given) == (goal, not goal)
    assert "macro_encoders" in sources_of(graph, "gravity")
    assert {"macro_limit", "mini_limit"} <= set(labels)
    for stage in ("macro", "mini"):
        assert_loop_closed(graph, f"{stage}_arm")


@pytest.mark.parametrize("figure", [*RUNS, "figure 5.6", "operational space"])
def test_the_picture_keeps_the_rules(figure):
    graph = control_graph(figure)
    check_ways(graph)
    check_texts(graph)
    if figure != "figure 5.6":
        check_structure(graph)
    assert describe(figure)


@pytest.mark.parametrize("within", [False, True])
def test_the_steps_do_what_the_loops_do(within):
    graph = control_graph("figure 5.6")
    labels, place, done = {node.name: node.label for node in graph.nodes}, "measure", []
    while not done or place != "measure":
        done.append(labels[place])
        ways = [edge for edge in graph.edges if edge.source == place]
        (place,) = (edge.target for edge in ways if edge.label in ("", "next period", "yes" if within else "no"))
    assert "Macro moves\ntowards its target" in done
    assert ("Mini moves to its target" in done, "Mini holds its posture" in done) == (within, not within)
