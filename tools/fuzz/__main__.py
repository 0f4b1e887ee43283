"""`python -m tools.fuzz`: try bad input and damage; exit code 1 if something is found."""

import sys

from runner.base.engines import quiet_environment
from tools.fuzz import main

quiet_environment()
sys.exit(0 if main(sys.argv[1:]) else 1)
