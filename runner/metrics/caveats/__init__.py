"""Caveats: rules that check a finished run for misleading results."""

from runner.metrics.caveats.monitor import Watch, look_together
from runner.metrics.caveats.plant_error import PlantStep
from runner.metrics.caveats.rule import Caveat, Found
from runner.metrics.caveats.setting import Setting, Signals, setting_of, signals_of
from runner.metrics.caveats.versions import changes_since

__all__ = [
    "Caveat",
    "Found",
    "PlantStep",
    "Setting",
    "Signals",
    "Watch",
    "changes_since",
    "look_together",
    "setting_of",
    "signals_of",
]
