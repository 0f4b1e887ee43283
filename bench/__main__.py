"""`python -m bench [NAME...]`: run the benchmarks; exit code 1 when a target is missed."""

import sys
from importlib import import_module

from runner.base.engines import has_pybullet, quiet_environment

NAMES = (
    "tick",
    "laws",
    "mujoco_tick",
    "derivatives",
    "caveats",
    "around",
    "repetitions",
    "cold_start",
    "reproduce",
    "sweep",
)
_AGAINST_PYBULLET = ("tick", "laws", "cold_start")  # they time its calls, or take an arm of its package

chosen = sys.argv[1:] or NAMES
if not set(chosen) <= set(NAMES):
    sys.exit(f"bench: choose from {', '.join(NAMES)}")
quiet_environment()
left_out = [] if has_pybullet() else [name for name in chosen if name in _AGAINST_PYBULLET]
for name in left_out:
    print(f"{name}: left out because PyBullet is not installed")
met = [import_module(f"bench.{name}").main() for name in chosen if name not in left_out]
sys.exit(0 if all(met) else 1)
