"""Runtime checks of sensor plug-ins."""

from typing import Any

from runner.base.arrays import FloatArray
from runner.base.errors import SimulationError
from runner.plugins.guard.faults import ask, checked, place
from runner.plugins.guard.read_only import read_only

_WHENEVER = float("nan")  # the loop knows the time, and puts it in


class WatchedEncoders:
    """Encoders of the user's; they end the run as a failure where they raise, or give no finite numbers of the shape.

    Args:
        encoders: What is watched.
    """

    def __init__(self, encoders: Any, *_: object) -> None:
        self._encoders = encoders

    def measure(self, tick: int, q: FloatArray, dq: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return their measurement; see Encoders."""
        law = self._encoders.measure
        answer = ask(law, _WHENEVER, tick, read_only(q), read_only(dq))
        if not isinstance(answer, tuple | list) or len(answer) != 2:
            raise SimulationError(f"{place(law)} gave {answer!r:.200}; it must be positions and velocities", _WHENEVER)
        positions, velocities = (checked(part, q.shape, law, _WHENEVER) for part in answer)
        return positions, velocities


class WatchedTorqueSensors:
    """Torque sensors of the user's in the joints, likewise.

    Args:
        sensors: What is watched.
    """

    def __init__(self, sensors: Any, *_: object) -> None:
        self._sensors = sensors

    def read(self, tick: int, torque: FloatArray) -> FloatArray:
        """Return their reading; see TorqueSensors."""
        return _read(self._sensors.read, tick, torque)


class WatchedWristSensor:
    """A force/torque sensor of the user's, likewise.

    Args:
        sensor: What is watched.
    """

    def __init__(self, sensor: Any, *_: object) -> None:
        self._sensor = sensor

    def read(self, tick: int, wrench: FloatArray) -> FloatArray:
        """Return its reading; see WristSensor."""
        return _read(self._sensor.read, tick, wrench)

    def overloads(self) -> list[str]:
        """Tell nothing: its readings say what becomes of a load beyond its range."""
        return []


def _read(law: Any, tick: int, load: FloatArray) -> FloatArray:
    return checked(ask(law, _WHENEVER, tick, read_only(load)), load.shape, law, _WHENEVER)
