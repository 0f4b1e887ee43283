"""The block graph of computed-torque control."""

from runner.controllers.graph import ControlGraph, Edge, Node


def computed_torque_graph(
    gravity_compensation: bool, feedforward: bool, torque_limited: bool, goal: bool, posture_task: bool
) -> ControlGraph:
    r"""Return the closed loop of the law that `ComputedTorque` executes.

    .. math:: \tau = M (\ddot q_d + k_v (\dot q_d - \dot q) + k_p (q_d - q)) + h, \qquad h = V + G

    The joint motion q_d comes from the desired motion of the tip alone; nothing that is measured enters it but where
    it starts. A term that the config leaves out is absent from the graph. The model's terms are taken at the measured
    state, which is the upper line of the picture.

    Args:
        gravity_compensation: Whether the law holds G(q).
        feedforward: Whether the law takes the desired velocity and acceleration.
        torque_limited: Whether torques are clipped.
        goal: Whether the reference is a goal at rest, which has no derivatives.
        posture_task: Whether the arm has joints to spare, which go home.
    """
    velocity, torque = r"V(q,\dot{q})", 6.8
    arm = torque + (2.15 if torque_limited else 1.0)
    followed = r"x_d,\dot{x}_d,\ddot{x}_d" if feedforward else "x_d"
    desired = "x_g" if goal else followed
    nodes = [
        Node("reference", "source", "Goal" if goal else "Trajectory", 0.0, 0.0),
        Node("resolved", "block", "Tip motion\nresolved\nto joints", 2.05, 0.0, 4),
        Node("position_error", "sum", "", 3.4, 1.0),
        Node("velocity_error", "sum", "", 3.4, -1.0),
        Node("k_p", "block", "$k_p$", 4.15, 1.0),
        Node("k_v", "block", "$k_v$", 4.15, -1.0),
        Node("ddq", "sum", "", 4.85, 0.0),
        Node("M", "block", "$M(q)$", 5.8, 0.0),
        Node("h", "block", f"${velocity}$\n$+\\ G(q)$" if gravity_compensation else f"${velocity}$", torque, -1.0),
        Node("tau", "sum", "", torque, 0.0),
        Node("arm", "block", "Arm", arm, 0.0),
        Node("encoders", "block", "Encoders", arm + 1.25, 0.0),
        Node("noise", "source", "Noise", arm + 2.5, 0.0),
    ]
    edges = [
        Edge("reference", "resolved", f"${desired}$"),
        Edge("resolved", "position_error", "$q_d$", "+"),
        Edge("resolved", "velocity_error", r"$\dot{q}_d$", "+"),
        Edge("resolved", "ddq", r"$\ddot{q}_d$", "+"),
        Edge("position_error", "k_p"),
        Edge("velocity_error", "k_v"),
        Edge("k_p", "ddq", sign="+", enter="bottom"),
        Edge("k_v", "ddq", sign="+", enter="top"),
        Edge("ddq", "M"),
        Edge("M", "tau", sign="+"),
        Edge("h", "tau", sign="+", leave="bottom", enter="top"),
        Edge("arm", "encoders", r"$q,\dot{q}$"),
        Edge("noise", "encoders", r"$\delta q$", leave="left", enter="right"),
        Edge("encoders", "velocity_error", r"$q,\dot{q}$ measured", "-", leave="top", enter="top", lane=-1.9),
        Edge("encoders", "M", leave="top", enter="top", lane=-1.9),
        Edge("encoders", "h", leave="top", enter="top", lane=-1.9),
        Edge("encoders", "position_error", "$q$ measured", "-", leave="bottom", enter="bottom", lane=1.9),
    ]
    if torque_limited:
        nodes.append(Node("limit", "block", "Limit\n" + r"$|\tau_i| \leq \tau_{\max}$", torque + 1.15, 0.0))
        edges += [Edge("tau", "limit", r"$\tau$"), Edge("limit", "arm")]
    else:
        edges.append(Edge("tau", "arm", r"$\tau$"))
    if posture_task:
        nodes.append(Node("posture", "source", "Home $q_0$", 2.05, 2.8))
        edges.append(Edge("posture", "resolved", leave="top", enter="bottom"))
    return ControlGraph(tuple(nodes), tuple(edges))
