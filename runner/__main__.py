"""`python -m runner` does what `runner` does."""

from runner.cli import main

main()
