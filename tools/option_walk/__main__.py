"""`python -m tools.option_walk`: walk over the options of a run; exit code 1 if one has no effect untold."""

import sys

from runner.base.engines import quiet_environment
from tools.option_walk import main

quiet_environment()
sys.exit(0 if main(sys.argv[1:]) else 1)
