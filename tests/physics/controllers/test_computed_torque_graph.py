"""Block diagram of computed torque: signals followed through the graph against the law's torques."""

import numpy as np
import pytest
from support.covers import SWITCH, covered, every_case
from support.graph_layout import check_structure, check_texts, check_ways

from runner.controllers.computed_torque import ComputedTorque, ComputedTorqueConfig
from runner.controllers.computed_torque_graph import computed_torque_graph

OPTIONS = dict.fromkeys(("gravity_compensation", "feedforward", "torque_limited", "goal", "posture_task"), SWITCH)
OMEGA, XI, LIMIT = 30.0, 0.8, 20.0


def evaluate(graph, model, q, dq, resolved):
    """Follow the signals from the resolved joint motion and the measured state to the torque at the arm's input."""
    labels = {node.name: node.label for node in graph.nodes}
    V = model.coriolis_torque(q, dq)
    gains = {"k_p": OMEGA**2 * np.eye(model.nq), "k_v": 2.0 * XI * OMEGA * np.eye(model.nq), "M": model.mass_matrix(q)}

    def signal(edge):
        if edge.source == "resolved":
            return resolved["dot" in edge.label and (2 if "ddot" in edge.label else 1)]
        if edge.source == "encoders":
            return dq if edge.target == "velocity_error" else q
        return value(edge.source)

    def value(name):
        if name == "h":
            return V + model.gravity_torque(q) if "G" in labels["h"] else V
        inputs = [e for e in graph.edges if e.target == name and not (e.source == "encoders" and name == "M")]
        total = sum((-1.0 if edge.sign == "-" else 1.0) * signal(edge) for edge in inputs)
        if name in gains:
            return gains[name] @ total
        return np.clip(total, -LIMIT, LIMIT) if name == "limit" else total

    return value("arm")


def test_the_graph_is_the_law_that_is_executed(xarm7):
    for flags in every_case(OPTIONS):
        config = ComputedTorqueConfig(
            kind="computed_torque", task="position", natural_frequency=OMEGA, damping_ratio=XI, period=1e-2,
            gravity_compensation=flags["gravity_compensation"], feedforward=flags["feedforward"],
            singularity_damping=0.0, null_space_frequency=10.0 if flags["posture_task"] else 0.0, integral_gain=0.0,
        )  # fmt: skip
        law, generator = ComputedTorque(xarm7.model, config, xarm7.home), np.random.default_rng(0)
        graph = computed_torque_graph(**flags)
        for _ in range(5):
            q, dq = xarm7.home + generator.uniform(-0.3, 0.3, 7), generator.uniform(-1.0, 1.0, 7)
            reference = generator.uniform(-1.0, 1.0, (3, 3))
            if flags["goal"]:
                reference[1:] = 0.0
            q_d, dq_d = np.split(law.start(q) if law.memory is None else law.memory, 2)
            tau = law.torque(0.0, q, dq, reference)
            resolved = q_d, dq_d, (np.split(law.memory, 2)[1] - dq_d) / 1e-2
            if flags["torque_limited"]:
                tau = np.clip(tau, -LIMIT, LIMIT)
            drawn = evaluate(graph, xarm7.model, q, dq, resolved)
            np.testing.assert_allclose(drawn, tau, atol=1e-9 * max(1.0, np.abs(tau).max()), err_msg=str(flags))


@pytest.mark.parametrize("flags", covered(OPTIONS))
def test_what_the_config_leaves_out_is_absent(flags):
    graph = computed_torque_graph(**flags)
    labels = {node.name: node.label for node in graph.nodes}
    assert ("G(q)" in labels["h"]) == flags["gravity_compensation"]
    assert ("limit" in labels) == flags["torque_limited"]
    assert ("posture" in labels) == flags["posture_task"]
    (given,) = [edge.label for edge in graph.edges if edge.source == "reference"]
    assert ("x_g" in given) == flags["goal"]
    assert ("dot" in given) == (flags["feedforward"] and not flags["goal"])


@pytest.mark.parametrize("flags", covered(OPTIONS))
def test_the_picture_keeps_the_rules(flags):
    graph = computed_torque_graph(**flags)
    check_structure(graph)
    check_ways(graph)
    if flags["torque_limited"]:  # the widest ones; drawing takes time
        check_texts(graph)
