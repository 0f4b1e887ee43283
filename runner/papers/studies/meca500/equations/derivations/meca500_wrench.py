"""Reference derivations of a wrench in another frame: force in N, moment in N mm, lengths in mm."""

import numpy as np
import pinocchio as pin

from runner.papers.audit.derivations import Derivations, Elements, Symbols, along
from runner.papers.studies.meca500.equations.derivations.meca500 import BY_MODEL, JOINTS


def symbols(count: int, generator: np.random.Generator) -> Symbols:
    """Return random wrenches in a frame S1 and random frames S2.

    `F` and `M_p` are the force and the moment about S1's origin, p, in S1. `R` turns vectors of S1 into S2, `P` is S1's
    origin in S2; `qp` is the vector from S2's origin, q, to p, in S1, `P_2` that from p to q; `r_p` is the lever of the
    force from p, `r_q` from q. `F_p` is `F`, `S` is `P`, and `I` the identity.
    """
    R = BY_MODEL.pose(generator.uniform(-np.pi, np.pi, (count, JOINTS)))[:, :3, :3]
    P, F, lever = (generator.uniform(-size, size, (count, 3)) for size in (100, 20, 80))
    qp = along(R.transpose(0, 2, 1), P)
    levers = {"r_p": lever, "r_q": lever + qp, "qp": qp, "P_2": -qp, "M_p": np.cross(lever, F)}
    return {"R": R, "P": P, "S": P, "F": F, "F_p": F, "I": np.tile(np.eye(3), (count, 1, 1)), **levers}


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


moved = Derivations(_by_vectors, _by_pinocchio, ("cross products", "wrenches carried over by Pinocchio"))
