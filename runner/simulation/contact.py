"""Contact of the tip in one run: external wrench, wrist sensor and their signals."""

import numpy as np

from runner.assembly.closed_loop import ClosedLoop
from runner.base.arrays import FloatArray
from runner.base.trace import ContactSignals
from runner.sensing import WristSensor

_NOTHING = np.zeros(6)


class Contact:
    """The contact of one run: it loads the sensor, passes readings to the controllers, and records signals.

    Args:
        closed: The closed loop; its interaction of arm and environment is reset here.
        wrist: Force/torque sensor, with a draw for each tick.

    Attributes:
        signals: Record of the run.
    """

    def __init__(self, closed: ClosedLoop, wrist: WristSensor) -> None:
        assert closed.interaction is not None  # noqa: S101 - the loop has contact
        self._plant = closed.plant
        self._interaction = closed.interaction
        self._wrist = wrist
        self._controllers = [loop.wrench_feedback for loop in closed.loops if loop.wrench_feedback is not None]
        self.signals = ContactSignals(*(np.zeros((closed.ticks + 1, 6)) for _ in range(5)))
        self._interaction.reset(closed.q_start)

    def update(self, k: int, time: float, q: FloatArray, dq: FloatArray) -> FloatArray:
        """Update with the state of tick k; return the external joint torques. See Interaction.update."""
        interaction, signals = self._interaction, self.signals
        contact = self._plant.contact_wrench()
        torques = interaction.update(time, q, dq, _NOTHING if contact is None else contact)
        reading = self._wrist.read(k, interaction.load)
        signals.external[k], signals.load[k], signals.reading[k] = interaction.external, interaction.load, reading
        reaction = self._plant.tool_reaction()
        if reaction is not None:
            signals.reaction[k] = interaction.to_flange_axes(reaction)
        for controller in self._controllers:
            controller.update_wrench(reading)
        if self._controllers:
            signals.felt[k] = self._controllers[0].external_wrench  # at its last tick
        return torques
