"""Block diagram of operational space control: signals followed through the graph against the law's torques."""

import numpy as np
import pytest
from support.arms import tip_numbers
from support.covers import SWITCH, covered, every_case
from support.graph_layout import assert_loop_closed, check_structure, check_texts, check_ways

from runner.controllers.operational_space.operational_space import OperationalSpace
from runner.studies.thesis.diagrams.operational_space import operational_space_graph

OPTIONS = dict.fromkeys(("gravity_compensation", "feedforward", "torque_limited", "goal"), SWITCH)


def evaluate(graph, model, q, dq, reference, k_p, k_v, limit):
    """Follow the signals from the reference and the measured state to the torque at the arm's input."""
    J = model.tip_jacobian(q)[:3]
    J_inverse = np.linalg.inv(J)
    Lambda = J_inverse.T @ model.mass_matrix(q) @ J_inverse
    mu = J_inverse.T @ model.coriolis_torque(q, dq) - Lambda @ model.tip_bias_acceleration(q, dq)
    state = {"position": model.tip_position(q), "velocity": J @ dq}
    gains = {"k_p": k_p, "k_v": k_v, "Lambda": Lambda, "J^T": J.T}
    edges = [edge for edge in graph.edges if edge.source != "encoders"]

    def signal(edge):
        if edge.source == "reference":  # the label of an edge names its derivative
            return reference[edge.label.count("dot") and (2 if "ddot" in edge.label else 1)]
        if edge.source in state:
            return state[edge.source]
        return value(edge.source)

    def value(name):
        inputs = [edge for edge in edges if edge.target == name]
        if name in ("mu", "p"):
            return mu if name == "mu" else J_inverse.T @ model.gravity_torque(q)
        total = sum((-1.0 if edge.sign == "-" else 1.0) * signal(edge) for edge in inputs)
        if name in gains:
            return gains[name] @ total if np.ndim(gains[name]) else gains[name] * total
        return np.clip(total, -limit, limit) if name == "limit" else total

    return value("arm")


def test_the_graph_is_the_law_that_is_executed(macro):
    for flags in every_case(OPTIONS):
        controller = OperationalSpace(
            macro, tip_numbers(30.0, 0.8, flags["gravity_compensation"], flags["feedforward"], 0.0)
        )
        graph, generator = operational_space_graph(**flags), np.random.default_rng(0)
        for _ in range(20):
            q, dq = generator.uniform(-1.0, 1.0, (2, 3))
            reference = generator.uniform(-1.0, 1.0, (3, 3))
            if flags["goal"]:
                reference[1:] = 0.0
            tau = controller.torque(0.0, q, dq, reference)
            if flags["torque_limited"]:
                tau = np.clip(tau, -50.0, 50.0)
            drawn = evaluate(graph, macro, q, dq, reference, k_p=900.0, k_v=48.0, limit=50.0)
            np.testing.assert_allclose(
                drawn, tau, rtol=1e-8, atol=1e-8 * max(1.0, np.abs(tau).max()), err_msg=str(flags)
            )


@pytest.mark.parametrize("flags", covered(OPTIONS))
def test_what_the_config_leaves_out_is_absent(flags):
    graph = operational_space_graph(**flags)
    names = {node.name for node in graph.nodes}
    labels = [edge.label for edge in graph.edges if edge.source == "reference"]
    assert ("p" in names) == flags["gravity_compensation"]
    assert ("limit" in names) == flags["torque_limited"]
    assert len(labels) == (3 if flags["feedforward"] and not flags["goal"] else 1)
    assert any("x_g" in label for label in labels) == flags["goal"]


@pytest.mark.parametrize("flags", covered(OPTIONS))
def test_the_picture_keeps_the_rules(flags):
    graph = operational_space_graph(**flags)
    check_structure(graph)
    check_ways(graph)
    assert_loop_closed(graph, "arm")


def test_its_texts_fit():
    check_texts(operational_space_graph(True, True, torque_limited=True, goal=False))  # the widest
