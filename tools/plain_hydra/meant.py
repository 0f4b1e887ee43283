"""Differences from plain Hydra that are meant, each with its reason."""

import re
from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Meant:
    """Difference that is meant.

    Attributes:
        outcomes: Outcomes of a line that it explains; see comparison.OUTCOMES.
        pattern: Pattern of the lines, whose overrides are joined by " | ".
        reason: Reason of the difference.
    """

    outcomes: Sequence[str]
    pattern: str
    reason: str


_ANY = ("different", "runner refuses", "Hydra refuses")
MEANT = (
    Meant(_ANY, r"(range|sort)\([^|]*\d(ms|mrad|g)\b", "values of functions have units; Hydra sorts them as text"),
    Meant(("different",), r"range\([^|)]*\d\.\d", "float ranges are counted in decimal, and exclude their stop"),
    Meant(("different",), r"range\(0,2\.5\)", "integers stay integers if only the stop is a float"),
    Meant(("different",), r"str\(", "a string stays a string; Hydra loses its quotes in a sweep"),
    Meant(("runner refuses",), r"glob\(q|range\(3,3\)", "a sweep over no value is refused; Hydra makes no run, exit 0"),
    Meant(
        ("different", "Hydra refuses"),
        r"(\b(?:robot|noise|torque_limits|preset))=.*\1=[^|]*\{|(\b(?:robot|noise|torque_limits|preset))=[^|]*\{.*\2="
        r"|params=\{noise: '",
        "an option and a mapping of one group both count, as in a single run; Hydra keeps the later one",
    ),
    Meant(("different",), r"(\b[\w.]+)=[^|]*\{.*\|.*\1=", "mappings of one key are merged, as in a single run"),
    Meant(
        ("different", "Hydra refuses", "runner refuses"),
        r"~([\w.]+)(?![\w.]).*\|.*\b\1|\b([\w]+)[\w.]*=.*~\2|~noise.*noise|noise.*~noise",
        "repeated keys around a deletion act in the order of the line, as in a single run",
    ),
    Meant(
        ("different",),
        r"\+\+([\w.]+)=.*\b\1=|\b([\w.]+)=.*\+\+\2=",
        "`++seed` and `seed` are one key on a command line",
    ),
    Meant(
        ("runner refuses",),
        r"experiment=sweep/\w+,sweep",
        "options of a list that bring axes are refused; Hydra loses the axes",
    ),
    Meant(
        ("different",), r"experiment=choice\(sweep/", "a list of one experiment brings its axes; Hydra loses the axes"
    ),
    Meant(("Hydra refuses",), r"params=.*(null|\{position)", "null and nested keys in hydra.sweeper.params are values"),
    Meant(
        ("Hydra refuses",),
        r"nope|nonsense|(?<![+\w])robot\.note",
        "unknown keys are judged after composition, all at once",
    ),
    Meant(("runner refuses",), r"oc\.env", "no override calls a function"),
    Meant(("different", "runner refuses"), r"~seed", "a deleted key stays deleted in all cells"),
)


def reason_for(line: Sequence[str], outcome: str) -> str:
    """Return the reason of a difference; "" if it is not meant."""
    text = " | ".join(line)
    return next((each.reason for each in MEANT if outcome in each.outcomes and re.search(each.pattern, text)), "")
