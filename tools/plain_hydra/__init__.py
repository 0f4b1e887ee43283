"""Lines of sweeps through plain Hydra and through the runner, with a reason for each difference that is meant."""

from tools.plain_hydra.comparison import main

__all__ = ["main"]
