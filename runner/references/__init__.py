"""Reference bands: what a run's metrics are checked against."""

from runner.references.reference import Band, Finding, Reference, check_run, load_reference
from runner.references.shipped import find_shipped, shipped_references

__all__ = [
    "Band",
    "Finding",
    "Reference",
    "check_run",
    "find_shipped",
    "load_reference",
    "shipped_references",
]
