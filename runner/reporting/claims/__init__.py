"""Published numbers, and whether our runs bear them out."""

from runner.reporting.claims.claim import FILE as CLAIMS
from runner.reporting.claims.claim import Bound, Extent, PublishedClaim, claimed, load_claims
from runner.reporting.claims.statement import PublishedStatement, load_statements, stated
from runner.reporting.claims.verdict import CONTRADICTION, FACTOR, Verdict, judge, judge_motion

__all__ = [
    "CLAIMS",
    "CONTRADICTION",
    "FACTOR",
    "Bound",
    "Extent",
    "PublishedClaim",
    "PublishedStatement",
    "Verdict",
    "claimed",
    "judge",
    "judge_motion",
    "load_claims",
    "load_statements",
    "stated",
]
