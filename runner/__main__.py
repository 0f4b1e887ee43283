"""`python -m runner` does what `runner` does."""

from runner.cli.main import main

main()
