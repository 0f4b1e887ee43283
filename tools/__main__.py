"""`python -m tools [NAME...]`: run the long checks; exit code 1 if one of them fails."""

import sys
from importlib import import_module

from runner.base.engines import quiet_environment

NAMES = (
    "agreement",
    "friction_coverage",
    "identification",
    "log_offsets",
    "made_up_logs",
    "answers",
    "scope",
    "kills",
    "processors",
    "mutants",
    "fuzz",
    "option_walk",
    "plain_hydra",
)

chosen = sys.argv[1:] or NAMES
if not set(chosen) <= set(NAMES):
    sys.exit(f"tools: choose from {', '.join(NAMES)}")
quiet_environment()
passed = [import_module(f"tools.{name}").main() for name in chosen]
sys.exit(0 if all(passed) else 1)
