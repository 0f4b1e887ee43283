"""What the plans of all works are made of: the runs that a report needs, and the presets that it compares."""

from dataclasses import dataclass

PRESETS = ("as_reported", "sound")


@dataclass(frozen=True)
class Job:
    """A run that a report needs.

    Attributes:
        overrides: The overrides that make it.
        ticks: Control ticks that it takes, roughly, for the estimate of what is left.
    """

    overrides: tuple[str, ...]
    ticks: int


Jobs = dict[str, Job]


def longest_first(jobs: Jobs) -> Jobs:
    """Return runs by name in the order in which to start them."""
    return dict(sorted(jobs.items(), key=lambda item: -item[1].ticks))
