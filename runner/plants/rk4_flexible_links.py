"""Flexible-link plant, integrated by the Runge-Kutta scheme."""

from collections.abc import Sequence
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError, SimulationError, nearest
from runner.base.lazy_modules import pin
from runner.plants.computation import ComputationConfig
from runner.plants.plant import Plant
from runner.plants.runge_kutta import runge_kutta
from runner.robots.robot import Robot, by_joint
from runner.robots.vibration import Beam, Chain, Mode, cut, find_modes, largest_rate, moving_links, span
from runner.schema.model import StrictModel
from runner.schema.units import Kilograms, MomentOfInertia, Newtons, Seconds
from runner.schema.values import MotorPerStage

_MOST_SEGMENTS = 32
_LIGHTEST = 1e-10  # smallest over largest inertia of a bending angle
_MOST_STEPS = 50
_AT_REST = 1e-10  # N m
_FARTHEST = 0.5  # rad, largest deflection of a spring


class BeamConfig(StrictModel):
    """Config of a flexible link.

    Attributes:
        EI: Bending stiffness, in N m^2.
        mass: Mass distributed evenly along the link, in addition to the link's mass in the robot file, in kg.
    """

    EI: Newtons[PositiveFloat]
    mass: Kilograms[NonNegativeFloat]


class Rk4FlexibleLinksConfig(StrictModel):
    """Config of a plant with flexible links.

    Attributes:
        kind: Name in the registry.
        step: Integration step, in s; None selects the fastest controller period.
        links: Flexible links, by name; None for a rigid link.
        segments: Springs along each flexible link; above 1 only for links with mass.
        motor_inertia: Inertia of each joint's motor after its gear, in kg m^2. One value for all joints or a list with
            one for each, by stage if the robot has several; None for a joint selects its `robot.armature`.
        damping_ratio: Damping ratio of each mode, with the motors held at home.
        computation: Delay and misses of the controllers' torques.
    """

    kind: Literal["rk4_flexible_links"]
    step: Seconds[PositiveFloat | None]
    links: dict[str, BeamConfig | None]
    segments: Annotated[int, Field(ge=1, le=_MOST_SEGMENTS)]
    motor_inertia: MomentOfInertia[MotorPerStage]
    damping_ratio: NonNegativeFloat
    computation: ComputationConfig

    def beams(self, robot: Robot) -> dict[str, Beam]:
        """Return the flexible links of a robot.

        Raises:
            ConfigError: if a link is unknown or has no length, no link is flexible, or a link without mass has several
                segments.
        """
        known, problems = moving_links(robot.model), []
        beams = {name: Beam(each.EI, each.mass) for name, each in self.links.items() if each is not None}
        for name, beam in beams.items():
            if name not in known:
                problems.append(f"plant.links.{name}: no such link{nearest(name, known)}; links: {', '.join(known)}")
            elif not np.any(span(robot.model, known[name], robot.flange)):
                problems.append(f"plant.links.{name}: the link has no length between its joints, and cannot bend")
            elif self.segments > 1 and beam.mass == 0.0:
                problems.append(
                    f"plant.links.{name}.mass: 0 found with plant.segments={self.segments}; parts between springs "
                    "move by their mass, so above 0, or plant.segments=1"
                )
        if not beams:
            problems.append("plant.links: null for every link; take plant=rk4 for rigid ones")
        if problems:
            raise ConfigError(problems)
        return beams

    def motors(self, robot: Robot) -> FloatArray:
        """Return B of a robot's joints, shape (nq,), in kg m^2.

        Raises:
            ConfigError: if values do not fit the robot's stages and joints, or a joint has both a motor inertia and an
                armature.
        """
        given, own = by_joint("plant.motor_inertia", self.motor_inertia, robot.stage_joints), robot.model.armature
        twice = np.isfinite(given) & (own > 0.0)
        if twice.any():
            name, armature = robot.model.joint_names[twice.argmax()], own[twice][0]
            raise ConfigError(
                f"plant.motor_inertia: {name} has robot.armature={armature:g}, too, and both are its motor; give null "
                 "here, or robot.armature=0"
            )  # fmt: skip
        return np.where(np.isfinite(given), given, own)

    def chain(self, robot: Robot) -> Chain:
        """Return the segments of a robot; see cut.

        Raises:
            ConfigError: see beams; also for segments with nearly no inertia.
        """
        chain = cut(robot.model, robot.flange, self.beams(robot), self.segments)
        M = chain.mass_matrix(robot.home)[np.ix_(chain.springs, chain.springs)]
        least, *_, most = np.linalg.eigvalsh(M)
        if least < _LIGHTEST * most:
            raise ConfigError(
                "plant.links: parts between springs have next to no inertia, and no step follows them; take "
                "more mass along the links, or plant.segments=1"
            )
        return chain

    def damping(self, robot: Robot) -> FloatArray:
        r"""Return the dampers among the springs, shape (k, k), in N m s/rad, from the modes with motors held at home.

        .. math:: D = M \Phi \, \mathrm{diag}(2 \zeta \omega) \, \Phi^T M, \qquad
            K \Phi = M \Phi \omega^2, \quad \Phi^T M \Phi = 1
        """
        from scipy.linalg import eigh  # needed by few configs

        chain = self.chain(robot)
        M = chain.mass_matrix(robot.home)[np.ix_(chain.springs, chain.springs)]
        squares, modes = eigh(np.diag(chain.stiffness), M)
        across = M @ modes
        damping: FloatArray = across * (2.0 * self.damping_ratio * np.sqrt(squares)) @ across.T
        return damping

    def largest_rate(self, robot: Robot) -> float:
        """Return the largest magnitude of an eigenvalue at home, in 1/s, without gravity and with free motors."""
        chain = self.chain(robot)
        M, (K, D) = chain.mass_matrix(robot.home), np.zeros((2, chain.pin_model.nv, chain.pin_model.nv))
        M[chain.motors, chain.motors] += self.motors(robot)
        K[chain.springs, chain.springs] = chain.stiffness
        D[np.ix_(chain.springs, chain.springs)] = self.damping(robot)
        return largest_rate(M, D, K)


class FlexibleLinks(Plant):
    r"""A chain of rigid segments with springs between them, integrated by the classical Runge-Kutta scheme.

    .. math:: M(x) \ddot x + h(x, \dot x) + K x + D \dot x = \tau

    x contains the joints, which the motors drive, and the bending angles of the links, which have springs and dampers.
    Pinocchio computes the dynamics.

    Args:
        chain: Segments of the arm.
        motors: B, inertia of each joint's motor after its gear, shape (nq,), in kg m^2.
        damping: D among the springs, shape (k, k), in N m s/rad.
        step: Integration step, in s.
        steps_per_tick: Integration steps for which the torques of one tick are held.
        ends: Frames at which the stages end, from the base outwards.
    """

    bends = True

    def __init__(
        self,
        chain: Chain,
        motors: FloatArray,
        damping: FloatArray,
        step: float,
        steps_per_tick: int,
        ends: Sequence[str],
    ) -> None:
        self._model = pin.Model(chain.pin_model)
        armature = np.zeros(self._model.nv)
        armature[chain.motors] = motors
        self._model.armature = armature
        self._data = self._model.createData()
        self._driven, self._springs = chain.motors, chain.springs
        self._K = np.zeros(self._model.nv)
        self._K[chain.springs] = chain.stiffness
        self._D = damping
        self._step, self._steps_per_tick = step, steps_per_tick
        self._ends = [self._model.getFrameId(name) for name in ends]
        self.places: FloatArray = np.zeros(self._model.nq)
        """x, shape (nq + k,), in rad."""
        self.speeds: FloatArray = np.zeros(self._model.nq)
        """dx/dt, shape (nq + k,), in rad/s."""
        self._time = 0.0
        self.q, self.dq = np.zeros(len(chain.motors)), np.zeros(len(chain.motors))

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Reset the joints to a state, and the links to static equilibrium with their weight; see Plant.

        Raises:
            SimulationError: if no equilibrium is found, or a spring bends too far for the chain to model a beam.
        """
        self._time = 0.0
        self.q[:], self.dq[:] = q, dq
        self.places[:] = self.speeds[:] = 0.0
        self.places[self._driven], self.speeds[self._driven] = q, dq
        on = self._springs
        for _ in range(_MOST_STEPS):
            left = pin.computeGeneralizedGravity(self._model, self._data, self.places) + self._K * self.places
            if np.abs(left[on]).max() < _AT_REST and np.abs(self.places[on]).max() < _FARTHEST:
                return
            slope = pin.computeGeneralizedGravityDerivatives(self._model, self._data, self.places) + np.diag(self._K)
            self.places[on] -= np.linalg.solve(slope[np.ix_(on, on)], left[on])
        raise SimulationError(
            f"a spring of the links bends by more than {_FARTHEST:g} rad under their weight", 0.0, None
        )

    def set_gravity(self, gravity: FloatArray) -> None:
        """Set the gravity vector; see Plant."""
        self._model.gravity.linear = gravity

    def advance(self, tau: FloatArray) -> None:
        """Hold the motors' torques for one tick; see Plant.

        Raises:
            SimulationError: if a spring bends too far for the chain to model a beam.
        """
        h, n = self._step, len(self.places)
        acting = np.zeros(n)
        acting[self._driven] = tau
        x = np.concatenate([self.places, self.speeds])
        x = runge_kutta(lambda at: self._slope(at, acting), x, h, self._steps_per_tick)
        self.places[:], self.speeds[:] = x[:n], x[n:]
        self._time += self._steps_per_tick * h
        if np.abs(self.places[self._springs]).max() > _FARTHEST:  # the loop reports values that are not finite
            raise SimulationError(f"a spring of the links bends by more than {_FARTHEST:g} rad", self._time, None)
        self.q[:], self.dq[:] = self.places[self._driven], self.speeds[self._driven]

    def _slope(self, x: FloatArray, acting: FloatArray) -> FloatArray:
        n = len(acting)
        places, speeds = x[:n], x[n:]
        forces = acting - self._K * places
        forces[self._springs] -= self._D @ speeds[self._springs]
        return np.concatenate([speeds, pin.aba(self._model, self._data, places, speeds, forces)])

    def end_points(self) -> FloatArray:
        """Return the end point of each stage, shape (stages, 3), in m."""
        pin.framesForwardKinematics(self._model, self._data, self.places)
        return np.array([self._data.oMf[end].translation for end in self._ends])

    def tip_motion(self) -> FloatArray:
        """Return position and velocity of the tip, shape (2, 3), in m and m/s."""
        model, data, tip = self._model, self._data, self._ends[-1]
        pin.forwardKinematics(model, data, self.places, self.speeds)
        place = pin.updateFramePlacement(model, data, tip)
        return np.array([place.translation, pin.getFrameVelocity(model, data, tip, pin.LOCAL_WORLD_ALIGNED).linear])

    def energy(self) -> float:
        """Return the energy of segments, motors and springs, in J."""
        M = np.triu(pin.crba(self._model, self._data, self.places))  # with the motors
        kinetic = float(self.speeds @ (M @ self.speeds)) - 0.5 * float(np.diag(M) @ self.speeds**2)
        weight = float(pin.computePotentialEnergy(self._model, self._data, self.places))
        return kinetic + weight + 0.5 * float(self._K @ self.places**2)


CONFIG = Rk4FlexibleLinksConfig


def build(config: Rk4FlexibleLinksConfig, robot: Robot, step: float, steps_per_tick: int) -> Plant:
    """Build the plant of a config."""
    ends = [*(str(stage.base_frame) for stage in robot.stages[1:]), robot.model.tip_name]
    chain, motors, damping = config.chain(robot), config.motors(robot), config.damping(robot)
    return FlexibleLinks(chain, motors, damping, step, steps_per_tick, ends)


def modes(config: Rk4FlexibleLinksConfig, robot: Robot, q: FloatArray) -> list[Mode]:
    """Return the modes of the links with the motors held."""
    chain = config.chain(robot)
    M = chain.mass_matrix(q)[np.ix_(chain.springs, chain.springs)]
    return find_modes(M, config.damping(robot), np.diag(chain.stiffness))


def moves_exactly(config: Rk4FlexibleLinksConfig) -> bool:
    """Return True: the scheme is of fourth order."""
    return True
