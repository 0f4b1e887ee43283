"""Reference derivations of the thesis arms' dimensions, home configurations, workspaces, frames and names."""

from itertools import combinations

import numpy as np

from runner.base.arrays import FloatArray
from runner.papers.audit.derivations import Derivations, Elements, Symbols, product, rotation
from runner.papers.audit.model_derivations import by_model
from runner.papers.studies.thesis.equations.derivations import thesis
from runner.papers.studies.thesis.equations.derivations.thesis_arms import COMBINED, MACRO, MINI, ThesisArm
from runner.papers.studies.thesis.equations.derivations.thesis_kinematics import model_step, tip_pose

_BASE_OF_MINI = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # 3_R_3', from the Mini's base


def _still(values: dict[str, float], s: Symbols) -> Elements:
    return {name: np.full(len(s["q1"]), value) for name, value in values.items()}


def _home(arm: ThesisArm) -> FloatArray:
    return np.zeros((1, arm.joints.stop - arm.joints.start))


# Table 2.1.


def _lengths(arm: ThesisArm) -> Derivations:
    def by_origins(s: Symbols) -> Elements:
        model = arm.model
        origins = model.frame_poses(_home(arm)[0], (*model.joint_names, model.tip_name))[:, :3, 3]
        lengths = np.linalg.norm(np.diff(origins, axis=0), axis=1)
        return _still({f"L_{arm.joints.start + i + 1}": length for i, length in enumerate(lengths)}, s)

    def by_tip(s: Symbols) -> Elements:
        model = arm.model
        stretched = [model.tip_position(np.array([0.0, 0.0, angle])) for angle in (-np.pi / 2, np.pi / 2)]
        reach, fold = (float(np.linalg.norm(point)) for point in stretched)
        last = float(np.linalg.norm(model.tip_jacobian(np.zeros(3))[:3, 2]))
        first = arm.joints.start + 1
        height = model.tip_position(np.array([0.0, 0.0, -np.pi / 2]))[2]  # links 2 and 3 lie level
        return _still({f"L_{first}": height, f"L_{first + 1}": reach - last, f"L_{first + 2}": (reach - fold) / 2}, s)

    return Derivations(
        by_origins, by_tip, ("distances of the model's joint origins", "postures and a column of the Jacobian")
    )


def _masses(arm: ThesisArm) -> Derivations:
    numbers = [arm.joints.start + i for i in (1, 2, 3)]

    def by_links(s: Symbols) -> Elements:
        masses = [inertia.mass for inertia in list(arm.model.pin_model.inertias)[1:]]
        return _still({f"m_{number}": mass for number, mass in zip(numbers, masses, strict=True)}, s)

    def by_torques(s: Symbols) -> Elements:
        model, home = arm.model, np.zeros(3)
        L2, L3 = arm.a[1:]
        m3 = model.mass_matrix(home)[2, 2] / L3**2
        m2 = model.gravity_torque(home)[1] / (9.81 * L2) - m3
        return _still(dict(zip((f"m_{number}" for number in numbers), (model.mass - m2 - m3, m2, m3), strict=True)), s)

    return Derivations(by_links, by_torques, ("the model's links", "what the joints feel at home: inertia and weight"))


macro_links, mini_links = _lengths(MACRO), _lengths(MINI)
macro_masses, mini_masses = _masses(MACRO), _masses(MINI)


# Workspace and home.


def _reach(arm: ThesisArm) -> Derivations:
    def by_search(s: Symbols) -> Elements:
        q3 = np.linspace(-np.pi, np.pi, 721)
        tips = arm.frame(3, np.column_stack([0 * q3, 0 * q3, q3]))[:, :3, 3]
        return _still({"R": float(np.linalg.norm(tips, axis=1).max())}, s)

    return Derivations(
        lambda s: _still({"R": arm.model.reach}, s),
        by_search,
        ("sum of the model's link lengths", "largest distance over all positions of joint 3"),
    )


def _at_home(arm: ThesisArm) -> Derivations:
    return arm.both(lambda d, s: {"x": np.tile(d.pose(_home(arm))[0, :3, 3], (len(s["q1"]), 1))})


macro_reach, mini_reach = _reach(MACRO), _reach(MINI)
macro_home, mini_home, combined_home = _at_home(MACRO), _at_home(MINI), _at_home(COMBINED)


# Names in the equations of transforms, velocities and points.


def symbols(count: int, generator: np.random.Generator) -> Symbols:
    """Return random states as `thesis.symbols` does, with the vectors and matrices of both arms.

    `T_01` to `T_2E` and `T_34` to `T_56` are the transforms of the links, `T_0E` and `T_36` those of the arms. `J` is
    the Jacobian of the Macro, `J_Mv` and `J_mv` are the linear ones, `dq_M` and `dq_m` joint velocities. The tip is at
    `x_d` and the end of the Macro at `x_E`, both in frame 0; `r` is the tip in frame 3, whose turn is `R_03`.
    """
    s = thesis.symbols(count, generator)
    q_M, q_m = MACRO.q(s), MINI.q(s)
    names = (("T_01", "T_12", "T_2E"), ("T_34", "T_45", "T_56"))
    steps = {
        name: model_step(arm, link, q)
        for arm, q, row in zip((MACRO, MINI), (q_M, q_m), names, strict=True)
        for link, name in enumerate(row, start=1)
    }
    J, J_m = by_model(MACRO.model).jacobian(q_M), by_model(MINI.model).jacobian(q_m)
    rates = {"J": J, "J_Mv": J[:, :3], "J_mv": J_m[:, :3], "dq_M": MACRO.dq(s), "dq_m": MINI.dq(s)}
    poses = {"x_d": tip_pose(COMBINED, COMBINED.q(s)), "x_E": tip_pose(MACRO, q_M), "r": tip_pose(MINI, q_m)}
    points = {name: pose[:, :3, 3] for name, pose in poses.items()} | {"T_0E": poses["x_E"], "T_36": poses["r"]}
    return {**s, **steps, **rates, **points, "R_03": base_of_mini(q_M)}


# Joint axes, and the frame between the arms.


def _axes_of_frames(s: Symbols) -> Elements:
    axes = np.array([COMBINED.frame(joint, _home(COMBINED))[0, :3, 2] for joint in range(6)])
    return {"axes": np.tile(axes.T, (len(s["q1"]), 1, 1))}


axes_at_home = Derivations(
    lambda s: {"axes": np.tile(COMBINED.model.tip_jacobian(np.zeros(6))[3:], (len(s["q1"]), 1, 1))},
    _axes_of_frames,
    ("angular Jacobian by Pinocchio", "z axes of the Denavit-Hartenberg frames"),
)

combined_tip = Derivations(
    lambda s: {"T": tip_pose(COMBINED, COMBINED.q(s))},
    lambda s: {"T": COMBINED.frame(6, COMBINED.q(s))},
    ("Pinocchio", "product of elementary turns and shifts, joint 4 along link 3"),
)


# The Mini's reference and its weight depend on how its base is turned.


def base_of_mini(q: FloatArray) -> FloatArray:
    """Return the rotation of the Mini's base, frame 3, at the Macro's joint positions (T, 3), shape (T, 3, 3)."""
    return np.asarray(tip_pose(MACRO, q)[:, :3, :3] @ _BASE_OF_MINI)


mini_offset = MINI.both(lambda d, s: {"r": d.pose(MINI.q(s))[:, :3, 3]})


macro_end_point = MACRO.both(lambda d, s: {"x": d.pose(MACRO.q(s))[:, :3, 3]})


riding_weight = COMBINED.both(lambda d, s: {"G": d.gravity(COMBINED.q(s))[:, 3:]})


# Names.


def _sums(*groups: str) -> Derivations:
    def angles(name: str, s: Symbols) -> list[FloatArray]:
        first, *rest = list(name.replace("_", ""))
        return [s[f"q{first}"], *((-1.0 if "_" in name else 1.0) * s[f"q{digit}"] for digit in rest)]

    def by_turns(s: Symbols) -> Elements:
        turns = {name: product([rotation("z", angle) for angle in angles(name, s)]) for name in groups}
        return {f"{letter}{name}": T[:, row, 0] for row, letter in enumerate("cs") for name, T in turns.items()}

    def by_phases(s: Symbols) -> Elements:
        phases = {name: np.prod(np.exp(1j * np.array(angles(name, s))), axis=0) for name in groups}
        return {f"c{n}": z.real for n, z in phases.items()} | {f"s{n}": z.imag for n, z in phases.items()}

    return Derivations(by_turns, by_phases, ("products of turns about one axis", "products of complex phases"))


macro_names = _sums("1", "2", "3", "12", "1_2", "123", "1_2_3")
mini_names = _sums("4", "5", "6", "45", "4_5", "456", "4_5_6")


# Sizes of the symbolic columns (3.22) and (3.23).


def _by_listing(s: Symbols) -> Elements:
    pairs = {n: len(list(combinations(range(int(n)), 2))) for n in np.unique(s["n"])}
    return {"squares": s["n"].copy(), "products": np.array([float(pairs[n]) for n in s["n"]])}


column_sizes = Derivations(
    lambda s: {"squares": s["n"], "products": np.array([np.triu(np.ones((int(n), int(n))), 1).sum() for n in s["n"]])},
    _by_listing,
    ("entries above the diagonal of n by n", "pairs listed"),
)
