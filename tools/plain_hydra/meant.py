"""Differences from plain Hydra that are meant, each with its reason.

No reason hides a fault: a refusal of the runner has the words of its row, and the cells are those that plain
Hydra composes as single runs of what is meant.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from tools.plain_hydra.cells import of_runner, single_runs


@dataclass(frozen=True)
class Meant:
    """Difference that is meant.

    Attributes:
        pattern: Pattern of the lines, whose overrides are joined by " | ".
        reason: Reason of the difference.
        instead: Text that means to plain Hydra what the pattern means to the runner; None for the same text.
        refusal: Pattern of the runner's message, if the runner refuses the line.
    """

    pattern: str
    reason: str
    instead: str | None = None
    refusal: str = ""


_DECIMAL = "float ranges are counted in decimal, and exclude their stop"
_UNITS = "values of functions have units; Hydra sorts them as text"
_STRINGS = "a string stays a string; Hydra loses its quotes in a sweep"
_BOTH = "an option and a mapping of one group both count, as in a single run; Hydra keeps the later one"
_PARAMS = "null and nested keys in hydra.sweeper.params are values"
_GROUP = r"\b(robot|noise|torque_limits|preset)"
MEANT = (
    Meant(r"range\(5ms,20ms,5ms\)", _UNITS, "0.005,0.01,0.015"),
    Meant(r"range\(10ms,30ms,10ms\)", _UNITS, "0.01,0.02"),
    Meant(r"sort\(20ms,5ms,10ms\)", _UNITS, "0.005,0.01,0.02"),
    Meant(r"sort\(20ms,10ms\)", _UNITS, "0.01,0.02"),
    Meant(r"range\(0,1,0\.1\)", _DECIMAL, "0.0,0.1,0.2,0.3,0.4,0.5,0.6,0.7,0.8,0.9"),
    Meant(r"range\(0\.1,0\.4,0\.1\)", _DECIMAL, "0.1,0.2,0.3"),
    Meant(r"range\(0,0\.3,0\.1\)", _DECIMAL, "0.0,0.1,0.2"),
    Meant(r"range\(0\.3,0,-0\.1\)", _DECIMAL, "0.3,0.2,0.1"),
    Meant(r"sort\(range\(5,0,-2\)\)", "a sorted range has the values of the range; Hydra adds one", "1,3,5"),
    Meant(r"range\(0,2\.5\)", "integers stay integers if only the stop is a float", "0,1,2"),
    Meant(r"\bstr\((\w+)\)", _STRINGS, r"'\1'"),
    Meant(r"\bstr\(\[1,2\]\)", _STRINGS, "['1','2']"),
    Meant(r"\bstr\(1,2\)", _STRINGS, "'1','2'"),
    Meant(
        r"glob\(q|range\(3,3\)",
        "a sweep over no value is refused; Hydra makes no run, exit 0",
        refusal="is swept over no value",
    ),
    Meant(_GROUP + r"=(?=.*\1=).*\{", _BOTH),
    Meant(r"params=\{noise: '.*noise=\{", _BOTH),
    Meant(r"\b([\w.]+)=\{.*\b\1=", "mappings of one key are merged, as in a single run"),
    Meant(
        r"\b([\w.]+)\.(\w+)=.*\b\1=[^|]*\{.*\b\1\.\2=",
        "a value after a mapping of its group wins, as in a single run; Hydra keeps the first place of a repeated key",
    ),
    Meant(
        r"~([a-z]+).*\|.*\b\1|\b([a-z]+)[\w.]*=.*~\2",
        "repeated keys around a deletion act in the order of the line, as in a single run",
    ),
    Meant(r"~[\w.]+( \||$)", "a key can be deleted in a sweep; Hydra 1.4.0rc3 compares its value with null"),
    Meant(r"\+\+([\w.]+)=.*\b\1=|\b([\w.]+)=.*\+\+\2=", "`++seed` and `seed` are one key on a command line"),
    Meant(
        r"experiment=sweep/\w+,sweep",
        "options of a list that bring axes are refused; Hydra loses the axes",
        refusal="brings axes .*, which a list does not sweep over",
    ),
    Meant(
        r"experiment=choice\((sweep/\w+)\)",
        "a list of one experiment brings its axes; Hydra loses the axes",
        r"experiment=\1",
    ),
    Meant(r"params=\{duration: null\} \| ", _PARAMS, "params={} | duration=null | "),
    Meant(r"params=\{noise: \{position: '(.*)'\}\}", _PARAMS, r"params={noise.position: '\1'}"),
    Meant(r"nope|nonsense|(?<![+\w])robot\.note", "unknown keys are judged after composition, all at once"),
    Meant(
        r"(?<=controller\.period)\.macro=0\.01,0\.02",
        "stages may get different values where all share a reference; OmegaConf 2.4.1rc1 changes what is referred to",
        "={macro:0.01,mini:0.001},{macro:0.02,mini:0.001}",
    ),
    Meant(r"oc\.env", "no override calls a function", refusal="calls a function"),
)


def reason_for(line: Sequence[str]) -> str:
    """Return the reason of a difference; "" if it is not meant."""
    text = " | ".join(line)
    rows = [row for row in MEANT if re.search(row.pattern, text)]
    ours = of_runner(line, range)
    if isinstance(ours, str):
        return next((row.reason for row in rows if row.refusal and re.search(row.refusal, ours)), "")
    for row in rows:
        if row.instead is not None:
            text = re.sub(row.pattern, row.instead, text)
    cells = {repr(cell) for cell in ours[1]}
    return rows[0].reason if rows and cells == {repr(cell) for cell in single_runs(text.split(" | "))} else ""
