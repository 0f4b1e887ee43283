"""Published numbers, and whether our runs bear them out."""

from runner.claims.claim import PublishedClaim, load_claims
from runner.claims.verdict import FACTOR, judge

__all__ = ["FACTOR", "PublishedClaim", "judge", "load_claims"]
