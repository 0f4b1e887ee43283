"""`python -m bench [NAME...]`: run the benchmarks; exit code 1 when a target is missed."""

import sys
from importlib import import_module

from runner.config.compose import quiet_environment

NAMES = (
    "tick",
    "laws",
    "mujoco_tick",
    "agreement",
    "caveats",
    "around",
    "cold_start",
    "reproduce",
    "sweep",
    "kills",
    "mutants",
    "fuzz",
)

chosen = sys.argv[1:] or NAMES
if not set(chosen) <= set(NAMES):
    sys.exit(f"bench: choose from {', '.join(NAMES)}")
quiet_environment()
met = [import_module(f"bench.{name}").main() for name in chosen]
sys.exit(0 if all(met) else 1)
