"""Contact of the tip in one run: external wrench, reading of the wrist sensor, and the record of both."""

from dataclasses import fields

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.trace import ContactSignals
from runner.environments.external_wrench import Interaction
from runner.plants import ReportsContact, ToolReactionPlant, unwrapped
from runner.sensing import WristSensor
from runner.simulation.closed_loop import ClosedLoop

_NOTHING = np.zeros(6)


class Contact:
    """The interaction of one run: it loads the sensor, passes its reading to the controllers, and keeps a record.

    Args:
        closed: The closed loop.
        interaction: Between arm and world; reset here.
        wrist: The force/torque sensor, with a draw for each tick.
    """

    def __init__(self, closed: ClosedLoop, interaction: Interaction, wrist: WristSensor) -> None:
        moved = unwrapped(closed.plant)
        self._contacts = moved if isinstance(moved, ReportsContact) else None
        self._reactions = moved if isinstance(moved, ToolReactionPlant) else None
        self._interaction = interaction
        self._wrist = wrist
        self._controllers = [loop.wrench_feedback for loop in closed.loops if loop.wrench_feedback is not None]
        self._signals = ContactSignals(*(np.zeros((closed.ticks + 1, 6)) for _ in range(5)))
        interaction.reset(closed.q_start)

    def update(self, k: int, time: float, q: FloatArray, dq: FloatArray) -> FloatArray:
        """Take the state at tick k, and return the joint torques of the world; see Interaction.update."""
        interaction, signals = self._interaction, self._signals
        contact = _NOTHING if self._contacts is None else self._contacts.contact_wrench()
        torques = interaction.update(time, q, dq, contact)
        reading = self._wrist.read(k, interaction.load)
        signals.external[k], signals.load[k], signals.reading[k] = interaction.external, interaction.load, reading
        reaction = None if self._reactions is None else self._reactions.tool_reaction()
        if reaction is not None:
            signals.reaction[k] = interaction.to_flange_axes(reaction)
        for controller in self._controllers:
            controller.update_wrench(reading)
        if self._controllers:
            signals.felt[k] = self._controllers[0].external_wrench  # of its last tick
        return torques

    def signals(self, kept: slice) -> ContactSignals:
        """Return the record of some ticks."""
        return ContactSignals(
            **{field.name: getattr(self._signals, field.name)[kept] for field in fields(ContactSignals)}
        )
