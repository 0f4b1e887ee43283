"""Reference derivations of the Meca500's force sensor: readings under a tool's weight and a contact.

Forces in N, moments in N mm. The sensor is rotated by theta about the flange's z axis: R_s = 0R6 Rz(theta). The
tool's weight G acts at (x, y, z) in the sensor frame; the readings have the offsets F_0 and M_0.
"""

from functools import reduce
from operator import or_

import numpy as np
import pinocchio as pin

from runner.base.arrays import FloatArray
from runner.papers.audit.derivations import Derivations, Elements, Symbols, columns, coordinates, rotation
from runner.papers.studies.meca500.equations.derivations.meca500 import BY_MODEL, JOINTS


def symbols(count: int, generator: np.random.Generator) -> Symbols:
    """Return free-hanging tools at random configurations, by the report's names.

    `F_x` to `M_z` are readings, with the offsets `F_x0` to `M_z0`; `x`, `y`, `z` the centre of gravity; `k1` to `k3`
    what the report calls so; `G` the weight, `theta` the sensor's turn, `Gcos` and `Gsin` their products; `r00` to
    `r22` the elements of the inverse of the flange's rotation, 6R0, counted from 0, `r13` to `r33` those of its last
    column counted from 1. The report does not define r; with 6R0 its equations hold, with 0R6 they do not.
    """
    return _symbols(count, generator, contact=0.0)


def contact_symbols(count: int, generator: np.random.Generator) -> Symbols:
    """Return the same with a contact: `Fe_x` to `Me_z`, of up to 20 N and 500 N mm, is part of the readings."""
    return _symbols(count, generator, contact=1.0)


def _symbols(count: int, generator: np.random.Generator, contact: float) -> Symbols:
    R = BY_MODEL.pose(generator.uniform(-np.pi, np.pi, (count, JOINTS)))[:, :3, :3]
    theta, G = generator.uniform(-np.pi, np.pi, count), generator.uniform(1, 8, count)
    r, F0 = generator.uniform(-60, 60, (count, 3)), generator.uniform(-10, 10, (count, 3))
    M0 = generator.uniform(-300, 300, (count, 3))
    Fe, Me = contact * generator.uniform(-20, 20, (count, 3)), contact * generator.uniform(-500, 500, (count, 3))
    force = weight(R, theta, G)
    moment = np.cross(r, force)
    vectors = {"F_": F0 + force + Fe, "M_": M0 + moment + Me, "G_": force, "M_g": moment, "Fe_": Fe, "Me_": Me}
    values = {name + a: vector[:, i] for name, vector in vectors.items() for i, a in enumerate("xyz")}
    values |= {f"F_{a}0": F0[:, i] for i, a in enumerate("xyz")} | {f"M_{a}0": M0[:, i] for i, a in enumerate("xyz")}
    values |= {a: r[:, i] for i, a in enumerate("xyz")} | {"G": G, "theta": theta}
    values |= {"Gcos": G * np.cos(theta), "Gsin": G * np.sin(theta)}
    values |= {f"r{i}{j}": R[:, j, i] for i in range(3) for j in range(3)}
    values |= {f"r{i + 1}3": R[:, 2, i] for i in range(3)}
    k = M0 + np.cross(F0, r)
    return values | {f"k{i + 1}": k[:, i] for i in range(3)}


def weight(R: FloatArray, theta: FloatArray, G: FloatArray) -> FloatArray:
    """Return a weight G in the sensor frame, turned by theta from a flange with rotation R, shape (T, 3)."""
    turned = R @ rotation("z", theta)[:, :3, :3]
    return -G[:, None] * turned[:, 2, :]


def _axes(values: Symbols, before: str = "", after: str = "") -> FloatArray:
    return columns(values, [f"{before}{axis}{after}" for axis in "xyz"])


def _flange(values: Symbols) -> FloatArray:
    """Return 0R6, shape (T, 3, 3)."""
    return np.array([[values[f"r{j}{i}"] for j in range(3)] for i in range(3)]).transpose(2, 0, 1)


def _loads(values: Symbols, force: FloatArray, moment: FloatArray) -> Elements:
    """Return everything that the report names, from the weight's force and moment in the sensor frame."""
    F0, M0, Fe, Me = (_axes(values, *names) for names in (("F_", "0"), ("M_", "0"), ("Fe_",), ("Me_",)))
    k = M0 - np.cross(_axes(values), F0)
    named = {"G_": force, "M_g": moment, "F_": F0 + force + Fe, "M_": M0 + moment + Me, "F_e": Fe, "M_e": Me}
    found = [coordinates(name, vectors, "") for name, vectors in named.items()]
    return reduce(or_, found, {f"k{i + 1}": k[:, i] for i in range(3)})


def _by_vectors(values: Symbols) -> Elements:
    force = weight(_flange(values), values["theta"], values["G"])
    return _loads(values, force, np.cross(_axes(values), force))


def _by_wrenches(values: Symbols) -> Elements:
    """Return the same, the weight carried from a frame upright at the centre of gravity to the sensor by Pinocchio."""
    wrenches = []
    for R, angle, G, r in zip(_flange(values), values["theta"], values["G"], _axes(values), strict=True):
        sensor = R @ pin.rpy.rpyToMatrix(0.0, 0.0, float(angle))
        wrenches.append(pin.SE3(sensor.T, r).act(pin.Force(np.array([0, 0, -G]), np.zeros(3))).vector)
    both = np.array(wrenches)
    return _loads(values, both[:, :3], both[:, 3:])


loads = Derivations(_by_vectors, _by_wrenches, ("turned weight and cross product", "wrench carried over by Pinocchio"))
turn = Derivations(
    lambda values: {"theta": values["theta"]},
    lambda values: {"theta": np.angle(values["Gcos"] + 1j * values["Gsin"])},
    ("the turn that was drawn", "angle of G cos + i G sin"),
)
