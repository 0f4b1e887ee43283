"""External forces at points of links, and the equivalent joint torques."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError, nearest
from runner.base.lazy_modules import pin
from runner.base.sanitize import quoted
from runner.environments import Environment
from runner.sensing.wrench import cross_matrix


class LinkForces:
    r"""Forces of an environment at points of links.

    .. math:: \tau = \sum_i (J_{v,i} - [r_i]_\times J_{\omega,i})^T f_i

    J_v and J_omega are the linear and angular Jacobian of a link, and r_i is the vector from the link's origin to the
    point.

    Args:
        environment: The environment.
        model: The arm's Pinocchio model.

    Raises:
        ConfigError: if the arm does not have a link.
    """

    def __init__(self, environment: Environment, model: "pin.Model") -> None:
        self._environment = environment
        links = [frame.name for frame in model.frames if frame.type == pin.FrameType.BODY]
        points = environment.points
        unknown = [link for link in points if link not in links]
        if unknown:
            raise ConfigError(
                f"environment.kind: it pushes the link {quoted(link)}, and the robot has none of that name"
                f"{nearest(link, links)}; links: {', '.join(links)}"
                for link in unknown
            )
        self._points = [(model.getFrameId(link), np.array(point, dtype=np.float64)) for link, point in points.items()]

    def torques(self, time: float, model: "pin.Model", data: "pin.Data", dq: FloatArray) -> FloatArray:
        """Return the joint torques equivalent to the forces, shape (nq,), in N m.

        Args:
            time: Time since the start, in s.
            model: The arm's Pinocchio model.
            data: Placements and joint Jacobians of the model at the true state of the arm.
            dq: True joint velocities, shape (nq,), in rad/s.
        """
        jacobians, positions = [], []
        for frame, point in self._points:
            place = pin.updateFramePlacement(model, data, frame)
            J = pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED).reshape(6, -1)
            arm = place.rotation @ point
            jacobians.append(J[:3] - cross_matrix(arm) @ J[3:])
            positions.append(place.translation + arm)
        stacked = np.reshape(jacobians, (-1, 3, len(dq)))
        forces = self._environment.link_forces(time, np.reshape(positions, (-1, 3)), stacked @ dq)
        torques: FloatArray = np.einsum("ixj,ix->j", stacked, forces)
        return torques
