"""Published claims: data, statements and verdicts."""

from runner.reporting.claims.claim import FILE as CLAIMS
from runner.reporting.claims.claim import Bound, Extent, PublishedClaim, load_claims, studies_with_claims
from runner.reporting.claims.statement import PublishedStatement, load_statements, studies_with_statements
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
    "judge",
    "judge_motion",
    "load_claims",
    "load_statements",
    "studies_with_claims",
    "studies_with_statements",
]
