"""The reports' words for names of the code: a reader should not have to know these."""

import re

PRESET = {"as_reported": "as reported", "sound": "full equations"}
"""The presets of the works, in the order of their columns."""

COUPLING = {
    "one_way": "one-way",
    "two_way": "two-way",
    "mini_held": "Mini held",
    "independent": "independent",
    "whole_body": "whole body",
}
"""How the controllers of the combined arm hang together."""

FOLDING = {"tip_goal": "the tip's own goal", "minus_home": "the goal less the Mini's home"}
"""Where the Macro of the combined arm is sent."""

_PRESET_NAME = re.compile(r"\b(as_reported|sound)\b")


def preset(name: str) -> str:
    """Return a preset, or a variant of one such as "sound, decoupled", in words."""
    return _PRESET_NAME.sub(lambda found: PRESET[found[0]], name)
