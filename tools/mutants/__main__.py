"""`python -m tools.mutants`: try mutants; exit code 1 where one is not found."""

import sys

from tools.mutants import main

sys.exit(0 if main(sys.argv[1:]) else 1)
