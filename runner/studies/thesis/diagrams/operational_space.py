"""Block diagram of operational-space control (thesis figures 3.4 and 3.7)."""

from runner.studies.thesis.diagrams.block_diagram import ControlGraph, Edge, Node


def operational_space_graph(
    gravity_compensation: bool, feedforward: bool, torque_limited: bool, goal: bool
) -> ControlGraph:
    r"""Return the closed loop of the law that `OperationalSpace` executes, eq. (3.32) with (3.33) or (3.40).

    .. math::

        F^* = \ddot x_d + k_v (\dot x_d - \dot x) + k_p (x_d - x), \qquad
        \tau = J^T (\hat\Lambda F^* + \hat\mu + \hat p)

    The graph omits a term that the config leaves out. All model terms are taken at the measured state, drawn as the
    upper and the lower line. The damping of J^-1 near a singular configuration, which the thesis does not have, is not
    shown.

    Args:
        gravity_compensation: True if the law includes p(x).
        feedforward: True if the law uses the desired velocity and acceleration.
        torque_limited: True if torques are clipped.
        goal: True if the reference is a goal at rest, which has no derivatives.
    """
    derivatives = feedforward and not goal
    arm, desired = (7.85, "x_g" if goal else "x_d") if torque_limited else (6.55, "x_g" if goal else "x_d")
    nodes = [
        Node("reference", "source", "Goal" if goal else "Trajectory", 0.0, *((0.0, 3) if derivatives else (1.0, 1))),
        Node("position_error", "sum", "", 1.3, 1.0),
        Node("k_p", "block", "$k_p$", 2.05, 1.0),
        Node("k_v", "block", "$k_v$", 2.05, -1.0),
        Node("F*", "sum", "", 2.75, 0.0),
        Node("Lambda", "block", r"$\hat{\Lambda}(x)$", 3.7, 0.0),
        Node("mu", "block", r"$\hat{\mu}(x,\dot{x})$", 4.6, -1.0),
        Node("F", "sum", "", 4.6, 0.0),
        Node("J^T", "block", "$J^T(q)$", 5.5, 0.0),
        Node("arm", "block", "Arm", arm, 0.0),
        Node("encoders", "block", "Encoders", arm + 1.25, 0.0),
        Node("noise", "source", "Noise", arm + 2.5, 0.0),
        Node("velocity", "block", r"$\dot{x} = J(q)\,\dot{q}$", 2.95, -2.0),
        Node("position", "block", "$x = f(q)$", 2.95, 2.0),
    ]
    edges = [
        Edge("reference", "position_error", f"${desired}$", "+"),
        Edge("position_error", "k_p"),
        Edge("k_p", "F*", sign="+", enter="bottom"),
        Edge("F*", "Lambda", r"$F\!^*$"),
        Edge("Lambda", "F", sign="+"),
        Edge("mu", "F", sign="+", leave="bottom", enter="top"),
        Edge("F", "J^T", "$F$"),
        Edge("arm", "encoders", r"$q,\dot{q}$"),
        Edge("noise", "encoders", r"$\delta q$", leave="left", enter="right"),
        Edge("encoders", "velocity", r"$q,\dot{q}$ measured", leave="top", enter="right"),
        Edge("encoders", "Lambda", leave="top", enter="top", lane=-2.0),
        Edge("encoders", "mu", leave="top", enter="top", lane=-2.0),
        Edge("encoders", "J^T", leave="top", enter="top", lane=-2.0),
        Edge("encoders", "position", "$q$ measured", leave="bottom", enter="right"),
        Edge("position", "position_error", "$x$", "-", leave="left", enter="bottom"),
    ]
    damping_nodes, damping_edges = damping(derivatives)
    nodes += damping_nodes
    edges += damping_edges
    if gravity_compensation:
        nodes.append(Node("p", "block", r"$\hat{p}(x)$", 4.6, 1.0))
        edges += [
            Edge("p", "F", sign="+", leave="top", enter="bottom"),
            Edge("encoders", "p", leave="bottom", enter="bottom", lane=2.0),
        ]
    if torque_limited:
        nodes.append(Node("limit", "block", "Limit\n" + r"$|\tau_i| \leq \tau_{\max}$", 6.72, 0.0))
        edges += [Edge("J^T", "limit", r"$\tau$"), Edge("limit", "arm")]
    else:
        edges.append(Edge("J^T", "arm", r"$\tau$"))
    return ControlGraph(tuple(nodes), tuple(edges))


def damping(derivatives: bool) -> tuple[list[Node], list[Edge]]:
    r"""Return the path from the tip's velocity to F*, through k_v.

    Args:
        derivatives: True if the law uses \dot x_d and \ddot x_d.
    """
    if not derivatives:
        return [], [
            Edge("velocity", "k_v", r"$\dot{x}$", leave="left", enter="top"),
            Edge("k_v", "F*", sign="-", enter="top"),
        ]
    return [Node("velocity_error", "sum", "", 1.3, -1.0)], [
        Edge("reference", "F*", r"$\ddot{x}_d$", "+"),
        Edge("reference", "velocity_error", r"$\dot{x}_d$", "+"),
        Edge("velocity", "velocity_error", r"$\dot{x}$", "-", leave="left", enter="top"),
        Edge("velocity_error", "k_v"),
        Edge("k_v", "F*", sign="+", enter="top"),
    ]
