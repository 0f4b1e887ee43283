"""Block diagram of whole-body control of a redundant arm (thesis figure 5.2)."""

from runner.studies.thesis.diagrams.block_diagram import ControlGraph, Edge, Node
from runner.studies.thesis.diagrams.operational_space import damping

_TASK, _TORQUE = 1.1, 3.2  # columns from F* to the summing points of the task and of the torques


def whole_body_graph(
    gravity_compensation: bool,
    feedforward: bool,
    torque_limited: bool,
    goal: bool,
    speed_limited: bool = False,
    posture_task: bool = True,
    all_joints: bool = False,
) -> ControlGraph:
    r"""Return the closed loop of the law that `WholeBody` executes.

    .. math::

        \tau = h + J^T \Lambda (F^* - \dot J \dot q) + N^T (K (q_0 - q) - k_{vn} M \dot q), \qquad h = V + G

    With all_joints, the last term is M (1 - J^+ J) (k_p0 (q_0 - q) - k_v0 dq), which N^T does not change. The graph
    omits a term that the config leaves out. All model terms are taken at the measured state, drawn as the upper and the
    lower line. The damping of Lambda near a singular configuration, which the thesis does not have, is not shown.

    Args:
        gravity_compensation: True if the law includes G(q).
        feedforward: True if the law uses the desired velocity and acceleration.
        torque_limited: True if torques are clipped.
        goal: True if the reference is a goal at rest, which has no derivatives.
        speed_limited: True if the approach to the goal saturates at a maximum tip speed V.
        posture_task: True if the null space has a posture task: null_space_frequency is not 0.
        all_joints: True if this task acts on all joints (PostureTask), False if on some (JointStiffness).
    """
    bottom = 4.0 if posture_task else 2.0
    force = 3.2 if speed_limited else 2.75
    torque = force + _TORQUE
    parts = [
        _loop(gravity_compensation, torque_limited, torque, bottom, r"q,\dot{q}" if posture_task else "q"),
        _task(feedforward and not goal, "x_g" if goal else "x_d", speed_limited, force, torque),
    ]
    if posture_task:
        parts.append(_posture(torque, bottom, all_joints))
    nodes = [node for part in parts for node in part[0]]
    edges = [edge for part in parts for edge in part[1]]
    return ControlGraph(tuple(nodes), tuple(edges))


def _loop(
    gravity_compensation: bool, torque_limited: bool, torque: float, bottom: float, below: str
) -> tuple[list[Node], list[Edge]]:
    """Return the arm, encoders, kinematics, h and the torque limit."""
    arm = torque + (2.15 if torque_limited else 1.0)
    velocity = r"V(q,\dot{q})"
    nodes = [
        Node("h", "block", f"${velocity}$\n$+\\ G(q)$" if gravity_compensation else f"${velocity}$", torque, -1.0),
        Node("tau", "sum", "", torque, 0.0),
        Node("arm", "block", "Arm", arm, 0.0),
        Node("encoders", "block", "Encoders", arm + 1.2, 0.0),
        Node("noise", "source", "Noise", arm + 2.4, 0.0),
        Node("velocity", "block", r"$\dot{x} = J(q)\,\dot{q}$", 2.75, -2.0),
        Node("position", "block", "$x = f(q)$", 2.2, bottom),
    ]
    edges = [
        Edge("h", "tau", sign="+", leave="bottom", enter="top"),
        Edge("arm", "encoders", r"$q,\dot{q}$"),
        Edge("noise", "encoders", r"$\delta q$", leave="left", enter="right"),
        Edge("encoders", "velocity", r"$q,\dot{q}$ measured", leave="top", enter="right"),
        Edge("encoders", "h", leave="top", enter="top", lane=-2.0),
        Edge("encoders", "position", f"${below}$ measured", leave="bottom", enter="right"),
    ]
    if torque_limited:
        nodes.append(Node("limit", "block", "Limit\n" + r"$|\tau_i| \leq \tau_{\max}$", torque + 1.15, 0.0))
        edges += [Edge("tau", "limit", r"$\tau$"), Edge("limit", "arm")]
    else:
        edges.append(Edge("tau", "arm", r"$\tau$"))
    return nodes, edges


def _task(
    derivatives: bool, desired: str, speed_limited: bool, force: float, torque: float
) -> tuple[list[Node], list[Edge]]:
    """Return the tip task, from the reference to J^T."""
    task = force + _TASK
    name = "Trajectory" if desired == "x_d" else "Goal"
    nodes = [
        Node("reference", "source", name, 0.0, *((0.0, 3) if derivatives else (1.0, 1))),
        Node("position_error", "sum", "", 1.3, 1.0),
        Node("k_p", "block", "$k_p$", 2.05, 1.0),
        Node("k_v", "block", "$k_v$", 2.05, -1.0),
        Node("F*", "sum", "", force, 0.0),
        Node("dJ_dq", "block", r"$\dot{J}\,\dot{q}$", task, -1.0),
        Node("task", "sum", "", task, 0.0),
        Node("Lambda", "block", r"$\Lambda$", task + 0.65, 0.0),
        Node("J^T", "block", "$J^T$", torque - 0.75, 0.0),
    ]
    edges = [
        Edge("reference", "position_error", f"${desired}$", "+"),
        Edge("position", "position_error", "$x$", "-", leave="left", enter="bottom"),
        Edge("position_error", "k_p"),
        Edge("F*", "task", r"$F\!^*$", "+"),
        Edge("dJ_dq", "task", sign="-", leave="bottom", enter="top"),
        Edge("task", "Lambda"),
        Edge("Lambda", "J^T"),
        Edge("J^T", "tau", sign="+"),
        *(
            Edge("encoders", tapped, leave="top", enter="top", lane=-2.0)
            for tapped in ("dJ_dq", "Lambda", "J^T")
        ),
    ]  # fmt: skip
    if speed_limited:
        nodes.append(Node("speed_limit", "block", "Limit\n" + r"$|\cdot| \leq k_v V$", force, 1.0))
        edges += [
            Edge("k_p", "speed_limit"),
            Edge("speed_limit", "F*", sign="+", leave="top", enter="bottom"),
        ]
    else:
        edges.append(Edge("k_p", "F*", sign="+", enter="bottom"))
    damping_nodes, damping_edges = damping(derivatives)
    return nodes + damping_nodes, edges + damping_edges


def _posture(torque: float, bottom: float, all_joints: bool) -> tuple[list[Node], list[Edge]]:
    """Return the posture task, projected into the null space of the tip task."""
    if all_joints:
        stiffness, damping, asked, projector = "$k_{p0}$", "$k_{v0}$", r"$\ddot{q}_0$", r"$M(1 - J^+\!J)$"
    else:
        stiffness, damping, asked, projector = "$K$", "$k_{vn} M$", r"$\tau_0$", "$N^T$"
    nodes = [
        Node("posture", "source", "Home", torque - 4.1, 2.0),
        Node("posture_error", "sum", "", torque - 2.95, 2.0),
        Node("K", "block", stiffness, torque - 2.2, 2.0),
        Node("k_vn", "block", damping, torque - 1.3, 3.0),
        Node("tau_0", "sum", "", torque - 1.3, 2.0),
        Node("N^T", "block", projector, torque, 2.0),
    ]
    edges = [
        Edge("posture", "posture_error", "$q_0$", "+"),
        Edge("posture_error", "K"),
        Edge("K", "tau_0", sign="+"),
        Edge("k_vn", "tau_0", sign="-", leave="top", enter="bottom"),
        Edge("tau_0", "N^T", asked),
        Edge("N^T", "tau", sign="+", leave="top", enter="bottom"),
        Edge("encoders", "posture_error", sign="-", leave="bottom", enter="bottom", lane=bottom),
        *(
            Edge("encoders", tapped, leave="bottom", enter="bottom", lane=bottom)
            for tapped in ("k_vn", "N^T")
        ),
    ]  # fmt: skip
    return nodes, edges
