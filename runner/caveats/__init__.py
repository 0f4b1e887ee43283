"""Caveats: rules that look at a finished run and say why its result may not be what it seems."""

from runner.caveats.caveat import Caveat, Found
from runner.caveats.plant_error import PlantStep
from runner.caveats.setting import Setting, setting_of
from runner.caveats.signals import Signals, signals_of
from runner.caveats.today import changes_since
from runner.caveats.watch import Watch, look_together

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
