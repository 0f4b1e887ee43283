"""Computing time of a plant relative to simulated time, from the timing of stored runs."""

from runner.store import Run


def cost(run: Run) -> float:
    """Return the median time that a tick took, over the time that it simulates."""
    return float(run.record["timing"]["tick_time_median"]) / float(run.config["controller"]["period"])
