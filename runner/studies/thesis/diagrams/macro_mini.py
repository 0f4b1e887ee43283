"""Block diagram of stage-wise Macro/Mini control (thesis figures 5.4, 5.5, 5.7 and 5.9)."""

from dataclasses import dataclass, field

from runner.studies.thesis.diagrams.block_diagram import ControlGraph, Edge, Node, Side

# Rows of the picture: above the Macro, between both arms, the Mini.
_OUTER, _OVER, _BETWEEN, _LANE, _ABOVE_MINI, _MINI, _UNDER = -2.2, -1.2, 1.7, 2.55, 3.35, 4.5, 5.6
_MINI_CONTROLLER = 5.5  # column


@dataclass(frozen=True)
class _Flags:
    """The config's switches, as in macro_mini_graph."""

    coupling: str
    macro_target: str
    moving: bool
    real: bool
    gravity: bool
    feedforward: bool
    limited: bool
    goal: bool
    turns: bool
    stretch: bool

    @property
    def follows(self) -> bool:
        return self.coupling in ("one_way", "two_way")

    @property
    def keeps_base_offset(self) -> bool:
        """True if the Mini keeps its home offset in the robot's base frame while its own base frame turns."""
        return self.coupling == "independent_base" and self.real

    @property
    def rotation(self) -> str:
        return "R" if self.real else "R_0"

    @property
    def spins(self) -> bool:
        """True if the velocity of the Mini's target depends on the Macro's."""
        return self.moving and (self.follows or self.keeps_base_offset)

    @property
    def rest(self) -> bool:
        """True if a block uses r = x_d - x_E."""
        return self.follows or self.turns

    @property
    def kinematics(self) -> bool:
        """True if a block uses the Macro's end point or rotation from its measured joints."""
        return self.rest or self.keeps_base_offset or (self.gravity and self.real)


@dataclass
class _Parts:
    """Nodes and edges, collected."""

    nodes: list[Node] = field(default_factory=list)
    edges: list[Edge] = field(default_factory=list)


def macro_mini_graph(
    coupling: str,
    macro_target: str,
    mini_reference_velocity: str,
    wrist_rotation: str,
    gravity_compensation: bool,
    feedforward: bool,
    torque_limited: bool,
    goal: bool,
    schedule: str,
    beyond_reach: str = "hold",
) -> ControlGraph:
    r"""Return the two closed loops that `MacroController` and `MiniController` (or `HeldController`) execute.

    Each arm's law is a block, the operational-space law of `operational_space_graph`. Encoders measure the Macro's
    joints q_M and the Mini's q_m. x_E is the Macro's end point, r = x_d - x_E, R the rotation of the Macro's last link,
    R_0 that at home, which replaces R if wrist_rotation is parallel, and rho the reach. The graph omits a signal that
    the config leaves out. The Mini's block notes that the Mini is mounted on the Macro, because this is not a signal.

    Args:
        coupling: one_way, two_way, independent, independent_base or mini_held; this and the next ones as in
            MacroMiniConfig.
        macro_target: minus_home or tip_goal; only one_way uses it.
        mini_reference_velocity: full or zero.
        wrist_rotation: real or parallel.
        gravity_compensation: True if the laws include the gravity term.
        feedforward: True if the Macro uses the desired velocity and acceleration.
        torque_limited: True if torques are clipped.
        goal: True if the reference is a goal at rest, which has no derivatives.
        schedule: both or turns.
        beyond_reach: hold or stretch.
    """
    flags = _Flags(
        coupling,
        macro_target,
        mini_reference_velocity == "full",
        wrist_rotation == "real",
        gravity_compensation,
        feedforward,
        torque_limited,
        goal,
        schedule == "turns",
        beyond_reach == "stretch",
    )
    parts = _Parts()
    _add_arm(parts, "macro", "Macro", 4.15 if flags.turns else 3.2, flags.limited)
    _add_arm(parts, "mini", "Mini", _MINI_CONTROLLER, flags.limited)
    _add_macro_target(parts, flags)
    if flags.kinematics:
        _add_kinematics(parts, flags)
    _add_mini_target(parts, flags)
    if flags.gravity:
        _add_gravity(parts, flags)
    return ControlGraph(tuple(parts.nodes), tuple(parts.edges))


def _add_arm(parts: _Parts, stage: str, name: str, controller: float, limited: bool) -> None:
    """Add the loop of an arm: controller, torque limit, arm, encoders."""
    macro = stage == "macro"
    index, row, lane = ("M", 0.0, _OVER) if macro else ("m", _MINI, _UNDER)
    outside: Side
    inside: Side
    outside, inside = ("top", "bottom") if macro else ("bottom", "top")
    arm = controller + (2.35 if macro else 2.6)
    encoders = arm + (1.2 if macro else 1.45)
    parts.nodes += [
        Node(f"{stage}_controller", "block", f"{name}\ncontroller", controller, row),
        Node(f"{stage}_arm", "block", "Macro\narm" if macro else "Mini arm\non Macro", arm, row),
        Node(f"{stage}_encoders", "block", f"{name}\nencoders", encoders, row),
        Node(f"{stage}_noise", "source", "Noise", encoders + 1.0, lane),
    ]
    measured = rf"$q_{index},\dot{{q}}_{index}$ measured"
    parts.edges += [
        Edge(f"{stage}_arm", f"{stage}_encoders"),
        Edge(f"{stage}_noise", f"{stage}_encoders", leave=inside, enter="right"),
        Edge(f"{stage}_encoders", f"{stage}_controller", measured, leave=outside, enter=outside, lane=lane),
    ]
    if limited:
        parts.nodes.append(Node(f"{stage}_limit", "block", "Limit", controller + 1.3, row))
        parts.edges += [
            Edge(f"{stage}_controller", f"{stage}_limit", rf"$\tau_{index}$"),
            Edge(f"{stage}_limit", f"{stage}_arm"),
        ]
    else:
        parts.edges.append(Edge(f"{stage}_controller", f"{stage}_arm", rf"$\tau_{index}$"))
    if not macro:
        parts.nodes.append(Node("tip", "block", "Tip $x$", arm, _ABOVE_MINI))
        parts.edges.append(Edge("mini_arm", "tip", leave="top", enter="bottom"))


def _add_macro_target(parts: _Parts, flags: _Flags) -> None:
    """Add the Macro's target x_d - o, and the test of the turn."""
    desired = "x_g" if flags.goal else "x_d"
    bundle = rf"{desired},\dot{{x}}_d,\ddot{{x}}_d" if flags.feedforward and not flags.goal else desired
    offset = flags.coupling != "one_way" or flags.macro_target == "minus_home"
    where = "macro_turn" if flags.turns else "macro_controller"
    row, rows = (_BETWEEN / 2.0, 4) if flags.rest else (0.0, 1)
    parts.nodes.append(Node("reference", "source", "Goal" if flags.goal else "Trajectory", -0.3, row, rows))
    if offset:
        parts.nodes.append(Node("macro_target", "sum", "", 1.5, 0.0))
        parts.edges += [
            Edge("reference", "macro_target", f"${bundle}$", "+"),
            Edge("macro_target", where, "" if flags.turns else f"${desired} - o$"),
        ]
    else:
        parts.edges.append(Edge("reference", where, f"${bundle}$"))
    if flags.coupling == "two_way":
        parts.nodes.append(Node("mini_offset", "block", f"$o = {flags.rotation}\\,p(q_m)$", 2.6, _OUTER))
        parts.edges += [
            Edge("mini_offset", "macro_target", "$o$", "-", leave="left", enter="top"),
            Edge("mini_encoders", "mini_offset", "$q_m$", leave="top", enter="right"),
        ]
        if flags.real:
            parts.edges.append(Edge("macro_encoders", "mini_offset", leave="top", enter="bottom", lane=_OVER))
    elif offset:
        parts.nodes.append(Node("home_offset", "source", "$o = r_0$", 1.5, _OVER))
        parts.edges.append(Edge("home_offset", "macro_target", sign="-", leave="bottom", enter="top"))
    if flags.turns:
        test = "Mini's turn\n" + r"and $|r| \leq \rho$?" + "\nthen hold"
        parts.nodes.append(Node("macro_turn", "block", test, 2.75, 0.0))
        parts.edges += [
            Edge("macro_turn", "macro_controller"),
            Edge("rest", "macro_turn", "$r$", leave="top", enter="bottom"),
        ]


def _add_kinematics(parts: _Parts, flags: _Flags) -> None:
    """Add the Macro's measured end point, and r = x_d - x_E."""
    moving = flags.follows and flags.moving
    parts.nodes.append(Node("kinematics", "block", "Macro\nkinematics", 4.5, _BETWEEN))
    symbol = r"$q_M,\dot{q}_M$" if flags.spins else "$q_M$"
    parts.edges.append(Edge("macro_encoders", "kinematics", symbol, leave="bottom", enter="right"))
    if not flags.rest:
        return
    desired = "x_g" if flags.goal else "x_d"
    parts.nodes.append(Node("rest", "sum", "", 1.5, _BETWEEN))
    parts.edges += [
        Edge("reference", "rest", rf"${desired},\dot{{x}}_d$" if moving and not flags.goal else f"${desired}$", "+"),
        Edge("kinematics", "rest", r"$x_E,\dot{x}_E$" if moving else "$x_E$", "-", leave="left", enter="right"),
    ]


def _add_mini_target(parts: _Parts, flags: _Flags) -> None:
    """Add the Mini's target: r within reach, its home offset, or its home configuration."""
    if flags.keeps_base_offset:
        _add_base_offset(parts, flags)
        return
    if not flags.follows:
        label = "Home configuration $q_0$" if flags.coupling == "mini_held" else "Home offset $r_0$"
        parts.nodes.append(Node("mini_target", "source", label, 3.3, _MINI))
        parts.edges.append(Edge("mini_target", "mini_controller"))
        return
    R = flags.rotation
    spin = r"(\dot{r} - \omega \times r)" if flags.real else r"\dot{r}"
    label = f"${R}^T r$" + (f"\n${R}^T {spin}$" if flags.moving else "")
    beyond = "stretch" if flags.stretch else "hold"
    test = r"$|r| \leq \rho$?" + f"\nelse {beyond}"
    if flags.turns:
        either = "else hold,\n" if flags.stretch else ""
        test = f"Own turn?\n{either}{test}"
    parts.nodes += [
        Node("mini_target", "block", label, 2.5, _MINI),
        Node("reach", "block", test, 4.05, _MINI),
    ]
    parts.edges += [
        Edge("rest", "mini_target", r"$r,\dot{r}$" if flags.moving else "$r$", leave="bottom", enter="left"),
        Edge("mini_target", "reach"),
        Edge("reach", "mini_controller"),
    ]
    if flags.real:
        symbol = r"$R,\omega$" if flags.moving else "$R$"
        parts.edges.append(Edge("kinematics", "mini_target", symbol, leave="bottom", enter="top", lane=_LANE))


def _add_base_offset(parts: _Parts, flags: _Flags) -> None:
    """Add the Mini's target R^T r_0, which keeps the home offset in the robot's base frame."""
    label = "$R^T r_0$" + ("\n" + r"$-R^T (\omega \times r_0)$" if flags.moving else "")
    parts.nodes += [
        Node("mini_offset_source", "source", "Home offset $r_0$", 0.9, _MINI),
        Node("mini_target", "block", label, 3.0, _MINI),
    ]
    symbol = r"$R,\omega$" if flags.moving else "$R$"
    parts.edges += [
        Edge("mini_offset_source", "mini_target"),
        Edge("mini_target", "mini_controller"),
        Edge("kinematics", "mini_target", symbol, leave="bottom", enter="top", lane=_LANE),
    ]


def _add_gravity(parts: _Parts, flags: _Flags) -> None:
    """Add gravity in the Mini's base frame."""
    label, place = f"${flags.rotation}^T g$", (_MINI_CONTROLLER, _ABOVE_MINI)
    parts.nodes.append(Node("gravity", "block" if flags.real else "source", label, *place))
    parts.edges.append(Edge("gravity", "mini_controller", leave="bottom", enter="top"))
    if flags.real:
        parts.edges.append(Edge("kinematics", "gravity", "$R$", leave="bottom", enter="top", lane=_LANE))
