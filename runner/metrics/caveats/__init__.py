"""Caveats: rules that check a finished run for misleading results."""

from runner.metrics.caveats.caveat import Caveat, Found
from runner.metrics.caveats.plant_error import PlantStep
from runner.metrics.caveats.setting import Setting, setting_of
from runner.metrics.caveats.signals import Signals, signals_of
from runner.metrics.caveats.today import changes_since
from runner.metrics.caveats.watch import Watch, look_together

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
