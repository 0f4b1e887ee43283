"""Published numbers, and whether our runs bear them out."""

from runner.claims.claim import Extent, PublishedClaim, load_claims
from runner.claims.verdict import FACTOR, judge, judge_motion

__all__ = ["FACTOR", "Extent", "PublishedClaim", "judge", "judge_motion", "load_claims"]
