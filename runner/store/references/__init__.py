"""Baselines: tolerance bands for the metrics of runs and sweeps."""

from runner.store.references.learned import Learned, Move, cell_names, find_moves, learn, load_learned
from runner.store.references.reference import (
    Band,
    Finding,
    Reference,
    check_run,
    find_shipped,
    load_reference,
    shipped_references,
)

__all__ = [
    "Band",
    "Finding",
    "Learned",
    "Move",
    "Reference",
    "cell_names",
    "check_run",
    "find_moves",
    "find_shipped",
    "learn",
    "load_learned",
    "load_reference",
    "shipped_references",
]
