"""Truths of a wrench in another frame: force in N, moment in N mm, lengths in mm."""

import numpy as np
import pinocchio as pin

from runner.audit.truth import Elements, Symbols, Truth, along
from runner.sensing.wrench import cross_matrix
from runner.studies.meca500.equations.truths.meca500 import BY_MODEL, JOINTS


def symbols(count: int, generator: np.random.Generator) -> Symbols:
    """Return random wrenches in a frame S1 and random frames S2.

    `F` and `M_p` are the force and the moment about S1's origin, p, in S1. `R` turns vectors of S1 into S2, `P` is S1's
    origin in S2; `qp` is the vector from S2's origin, q, to p, in S1, `P_2` that from p to q; `r_p` is the lever of the
    force from p, `r_q` from q.
    """
    R = BY_MODEL.pose(generator.uniform(-np.pi, np.pi, (count, JOINTS)))[:, :3, :3]
    P, F, lever = (generator.uniform(-size, size, (count, 3)) for size in (100, 20, 80))
    qp = along(R.transpose(0, 2, 1), P)
    return {"R": R, "P": P, "F": F, "r_p": lever, "r_q": lever + qp, "qp": qp, "P_2": -qp, "M_p": np.cross(lever, F)}


def by_lever(values: Symbols) -> Elements:
    """Return r_q x F."""
    return {"M_q": np.cross(values["r_q"], values["F"])}


def by_shorter_lever(values: Symbols) -> Elements:
    """Return r_p x F + qp x F as the moment about p, as printed."""
    return {"M_p": np.cross(values["r_p"], values["F"]) + np.cross(values["qp"], values["F"])}


def by_shift(values: Symbols) -> Elements:
    """Return M_p + qp x F, where M_p is r_p x F."""
    return {"M_q": values["M_p"] + np.cross(values["qp"], values["F"])}


def by_matrix(values: Symbols) -> Elements:
    """Return the product of the shift and the turn, both 6 by 6, and the wrench in S1."""
    count = len(values["F"])
    shift, turn = np.tile(np.eye(6), (count, 1, 1)), np.zeros((count, 6, 6))
    shift[:, 3:, :3] = [cross_matrix(P) for P in values["P"]]
    turn[:, :3, :3] = turn[:, 3:, 3:] = values["R"]
    return {"wrench": along(shift @ turn, np.hstack([values["F"], values["M_p"]]))}


def composed(values: Symbols) -> Elements:
    """Return the product of a shift and a turn as homogeneous transforms."""
    shift = np.tile(np.eye(4), (len(values["P"]), 1, 1))
    turn = shift.copy()
    shift[:, :3, 3], turn[:, :3, :3] = values["P"], values["R"]
    return {"T": shift @ turn}


def _by_vectors(values: Symbols) -> Elements:
    moment = np.cross(values["r_q"], values["F"])
    turned = np.hstack([along(values["R"], values["F"]), along(values["R"], moment)])
    T = np.tile(np.eye(4), (len(moment), 1, 1))
    T[:, :3, :3], T[:, :3, 3] = values["R"], values["P"]
    return {"M_p": np.cross(values["r_p"], values["F"]), "M_q": moment, "wrench": turned, "T": T, "P": values["P"]}


def _by_pinocchio(values: Symbols) -> Elements:
    """Return the same by Pinocchio: the force as a pure force at its point of attack, carried to p, to q and to S2."""
    zero = np.zeros(3)
    rows = zip(*(values[name] for name in ("R", "P", "F", "r_p", "r_q")), strict=True)
    found = [
        (
            pin.SE3(np.eye(3), r_p).act(pin.Force(F, zero)).angular,
            pin.SE3(np.eye(3), r_q).act(pin.Force(F, zero)).angular,
            pin.SE3(R, P).act(pin.SE3(np.eye(3), r_p).act(pin.Force(F, zero))).vector,
            pin.SE3(R, P).homogeneous,
            pin.SE3(R, P).translation,
        )
        for R, P, F, r_p, r_q in rows
    ]
    return {name: np.array([row[i] for row in found]) for i, name in enumerate(("M_p", "M_q", "wrench", "T", "P"))}


moved = Truth(_by_vectors, _by_pinocchio, ("cross products", "wrenches carried over by Pinocchio"))
