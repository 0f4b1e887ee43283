import itertools

import numpy as np
import pytest

from runner.controllers.operational_space import OperationalSpace
from runner.controllers.operational_space_graph import operational_space_graph
from runner.robots import RobotModel, find_urdf, read_urdf

FLAGS = list(itertools.product([False, True], repeat=4))
NAMES = ("gravity_compensation", "feedforward", "torque_limited", "goal")


def graph_of(flags):
    return operational_space_graph(**dict(zip(NAMES, flags, strict=True)))


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
        if edge.source == "reference":  # which derivative an edge carries, its label tells
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


@pytest.mark.parametrize("flags", FLAGS)
def test_the_graph_is_the_law_that_is_executed(flags):
    gravity_compensation, feedforward, torque_limited, goal = flags
    model = RobotModel(read_urdf(find_urdf("macro.urdf"), {}), "tip")
    controller = OperationalSpace(model, 30.0, 0.8, gravity_compensation, feedforward, singularity_damping=0.0)
    generator = np.random.default_rng(0)
    for _ in range(20):
        q, dq = generator.uniform(-1.0, 1.0, (2, 3))
        reference = generator.uniform(-1.0, 1.0, (3, 3))
        if goal:
            reference[1:] = 0.0
        tau = controller.torque(0.0, q, dq, reference)
        if torque_limited:
            tau = np.clip(tau, -50.0, 50.0)
        drawn = evaluate(graph_of(flags), model, q, dq, reference, k_p=900.0, k_v=48.0, limit=50.0)
        np.testing.assert_allclose(drawn, tau, rtol=1e-8, atol=1e-8 * max(1.0, np.abs(tau).max()))


@pytest.mark.parametrize("flags", FLAGS)
def test_what_the_config_leaves_out_is_absent(flags):
    gravity_compensation, feedforward, torque_limited, goal = flags
    graph = graph_of(flags)
    names = {node.name for node in graph.nodes}
    labels = [edge.label for edge in graph.edges if edge.source == "reference"]
    assert ("p" in names) == gravity_compensation
    assert ("limit" in names) == torque_limited
    assert len(labels) == (3 if feedforward and not goal else 1)
    assert any("x_g" in label for label in labels) == goal


@pytest.mark.parametrize("flags", FLAGS)
def test_every_edge_joins_two_nodes_and_every_node_takes_part(flags):
    graph = graph_of(flags)
    kinds = {node.name: node.kind for node in graph.nodes}
    assert len(kinds) == len(graph.nodes)
    assert all(edge.source in kinds and edge.target in kinds for edge in graph.edges)
    fed = {edge.target for edge in graph.edges}
    assert {name for name, kind in kinds.items() if kind == "source"} == set(kinds) - fed
    assert all((edge.sign != "") == (kinds[edge.target] == "sum") for edge in graph.edges)
    assert set(kinds) == {edge.source for edge in graph.edges} | fed


@pytest.mark.parametrize("flags", FLAGS)
def test_the_loop_is_closed(flags):
    graph = graph_of(flags)
    reached, frontier = set(), {"arm"}
    while frontier:
        frontier = {edge.target for edge in graph.edges if edge.source in frontier} - reached
        reached |= frontier
    assert "arm" in reached
