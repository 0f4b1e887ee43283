"""Block diagram of whole-body control: signals followed through the graph against the law's torques."""

import numpy as np
import pytest
from support.covers import SWITCH, covered, every_case
from support.graph_layout import check_structure, check_texts, check_ways

from runner.controllers.operational_space.whole_body import WholeBody, WholeBodyConfig
from runner.studies.thesis.diagrams.whole_body import whole_body_graph

NAMES = ("gravity_compensation", "feedforward", "torque_limited", "goal", "speed_limited", "posture_task")
OPTIONS = dict.fromkeys(NAMES, SWITCH)
OF_ALL_JOINTS = OPTIONS | {"posture_task": (True,)}
OMEGA, XI, OMEGA_N, SPEED, LIMIT = 30.0, 0.8, 20.0, 0.5, 40.0
REST = np.array([0.0, 0.0, 0.0, 0.1, -0.2, 0.3])


def law_of(model, flags, **more):
    config = WholeBodyConfig(
        kind="whole_body", natural_frequency=OMEGA, damping_ratio=XI, period=1e-3, singularity_damping=0.0,
        gravity_compensation=flags["gravity_compensation"], feedforward=flags["feedforward"],
        null_space_frequency=OMEGA_N if flags["posture_task"] else 0.0,
        max_tip_speed=SPEED if flags["speed_limited"] else None,
    )  # fmt: skip
    return WholeBody(model, config, REST, **more)


def evaluate(graph, robot, q, dq, reference, rest):
    """Follow the signals from the reference and the measured state to the torque at the arm's input."""
    model = robot.model
    J, M = model.tip_jacobian(q)[:3], model.mass_matrix(q)
    Lambda = np.linalg.inv(J @ np.linalg.inv(M) @ J.T)
    N = np.eye(6) - np.linalg.inv(M) @ J.T @ Lambda @ J
    k_p, k_v = OMEGA**2, 2.0 * XI * OMEGA
    at_rest = model.tip_jacobian(rest)[:3]
    Z = np.vstack([-np.linalg.solve(at_rest[:, :3], at_rest[:, 3:]), np.eye(3)])  # the Mini moves, the tip does not
    K = np.zeros((6, 6))
    K[3:, 3:] = OMEGA_N**2 * Z.T @ model.mass_matrix(rest) @ Z
    labels = {node.name: node.label for node in graph.nodes}
    V = model.coriolis_torque(q, dq)
    known = {
        "position": model.tip_position(q),
        "velocity": J @ dq,
        "dJ_dq": model.tip_bias_acceleration(q, dq),
        "h": V + model.gravity_torque(q) if "G" in labels["h"] else V,
        "k_vn": 2.0 * OMEGA_N * M @ dq,
        "posture": rest,
        "encoders": q,  # what the posture's summing point takes of it
    }
    gains = {"k_p": k_p * np.eye(3), "k_v": k_v * np.eye(3), "Lambda": Lambda, "J^T": J.T, "N^T": N.T,
             "K": K}  # fmt: skip
    taps = {"h", "dJ_dq", "k_vn", *gains}

    def signal(edge):
        if edge.source == "reference":
            return reference[edge.label.count("dot") and (2 if "ddot" in edge.label else 1)]
        return value(edge.source)

    def value(name):
        if name in known:
            return known[name]
        inputs = [e for e in graph.edges if e.target == name and not (e.source == "encoders" and name in taps)]
        total = sum((-1.0 if edge.sign == "-" else 1.0) * signal(edge) for edge in inputs)
        if name in gains:
            return gains[name] @ total
        if name == "speed_limit":
            return total * min(1.0, k_v * SPEED / np.linalg.norm(total))
        return np.clip(total, -LIMIT, LIMIT) if name == "limit" else total

    return value("arm")


def test_the_graph_is_the_law_that_is_executed(combined):
    for flags in every_case(OPTIONS):
        law, graph = law_of(combined.model, flags), whole_body_graph(**flags)
        generator = np.random.default_rng(0)
        for _ in range(5):
            q, dq = generator.uniform(-1.0, 1.0, (2, 6))
            reference = generator.uniform(-1.0, 1.0, (3, 3))
            if flags["goal"]:
                reference[1:] = 0.0
            tau = law.torque(0.0, q, dq, reference)
            if flags["torque_limited"]:
                tau = np.clip(tau, -LIMIT, LIMIT)
            drawn = evaluate(graph, combined, q, dq, reference, REST)
            atol = 1e-7 * max(1.0, np.abs(tau).max())
            np.testing.assert_allclose(drawn, tau, rtol=1e-7, atol=atol, err_msg=str(flags))


@pytest.mark.parametrize("flags", covered(OPTIONS))
def test_what_the_config_leaves_out_is_absent(flags):
    graph = whole_body_graph(**flags)
    labels = {node.name: node.label for node in graph.nodes}
    assert ("G(q)" in labels["h"]) == flags["gravity_compensation"]
    assert ("limit" in labels) == flags["torque_limited"]
    assert ("speed_limit" in labels) == flags["speed_limited"]
    assert ({"posture", "K", "k_vn", "N^T"} <= set(labels)) == flags["posture_task"]
    given = [edge.label for edge in graph.edges if edge.source == "reference"]
    assert len(given) == (3 if flags["feedforward"] and not flags["goal"] else 1)
    assert any("x_g" in label for label in given) == flags["goal"]


@pytest.mark.parametrize("flags", covered(OPTIONS))
def test_the_picture_keeps_the_rules(flags):
    graph = whole_body_graph(**flags)
    check_structure(graph)
    check_ways(graph)


# The wide ones; those with both limits are the widest. Drawing takes time.
@pytest.mark.parametrize("flags", covered(OPTIONS | {"torque_limited": (True,), "speed_limited": (True,)}))
def test_its_texts_fit(flags):
    check_texts(whole_body_graph(**flags))


@pytest.mark.slow
def test_texts_of_pictures_with_one_limit_fit():
    """Narrower than those with both, which each session draws."""
    for flags in every_case(OPTIONS):
        if flags["torque_limited"] != flags["speed_limited"]:
            check_texts(whole_body_graph(**flags))


def test_the_posture_of_all_joints_adds_what_its_blocks_say(combined):
    for flags in every_case(OF_ALL_JOINTS):
        graph = whole_body_graph(**flags, all_joints=True)
        labels = {node.name: node.label for node in graph.nodes}
        assert (labels["K"], labels["k_vn"], labels["N^T"]) == ("$k_{p0}$", "$k_{v0}$", r"$M(1 - J^+\!J)$")
        generator = np.random.default_rng(1)
        q, dq, reference = *generator.uniform(-1.0, 1.0, (2, 6)), generator.uniform(-1.0, 1.0, (3, 3))
        with_posture, without = (
            law_of(combined.model, flags | {"posture_task": on}, first_held=0).torque(0.0, q, dq, reference).copy()
            for on in (True, False)
        )
        J = combined.model.tip_jacobian(q)[:3]
        projector = combined.model.mass_matrix(q) @ (np.eye(6) - np.linalg.pinv(J) @ J)
        expected = projector @ (OMEGA_N**2 * (REST - q) - 2.0 * OMEGA_N * dq)
        np.testing.assert_allclose(with_posture - without, expected, atol=1e-9 * np.abs(with_posture).max())


@pytest.mark.parametrize("flags", covered(OF_ALL_JOINTS))
def test_the_picture_of_the_posture_of_all_joints_keeps_the_rules(flags):
    graph = whole_body_graph(**flags, all_joints=True)
    check_structure(graph)
    check_ways(graph)


def test_texts_of_the_posture_of_all_joints_fit():
    check_texts(whole_body_graph(**dict.fromkeys(NAMES, True), all_joints=True))  # all blocks and signals
