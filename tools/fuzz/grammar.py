"""Input of a careless or hostile user: values, configs, overrides and YAML files, drawn from a seed."""

import copy
import json
import string
from random import Random
from typing import Any

NUMBERS = (
    0, 1, -1, 2, 7, 10, 100, 10**9, 10**18, 10**19, 10**400, 2**63, -(2**63), 0.0, -0.0, 0.5, 1.0, 3.0, -1.5, 90.0,
    1e-3, 1e-6, 1e-12, 1e-13, 5e-324, 1e9, 1e12, 1e13, 1e100, 1.7e308, -1e300, float("inf"), float("-inf"),
    float("nan"),
)  # fmt: skip
TEXTS = (
    "", " ", "x", "null", "true", "1e400", "macro", "full_equations", "bullet", "quintic", "../../etc/passwd",
    "/etc/passwd",
    "~", "a b", "ä°中", "\x1b]0;pwn\x07", "\x1b[2J", "\x9b", "\u202e", "line\nbreak", "\r\t", '=HYPERLINK("http://x")',
    "@SUM(1)", "-2+3", "<script>alert(1)</script>", "'\"`;$(touch pwned)", "%s%n", "{}", "[]", "${", "$}", "\\",
    "\\${x}", "#read(\"/etc/passwd\")", "__class__", "_target_", "NaN", "x" * 201, "x" * 5000, "[" * 300, "{a:" * 90,
)  # fmt: skip
REFERENCES = (
    "${robot.period}", "${robot.goal}", "${robot}", "${nope.x}", "${.x}", "${..x}", "${oc.env:HOME}", "${oc.env:NOPE}",
    "${oc.decode:1e400}", "${oc.create:{a: 1}}", "${${preset.dynamics}}", "${robot.${preset.dynamics}}", "${now:%H}",
    "${hydra:run.dir}", "x${robot.name}y", "${controller}", "${trajectory.goal[0]}", "${a", "${robot.masses.link2}",
)  # fmt: skip
UNKNOWN = (
    "x",
    "robot.x",
    "controler.period",
    "robot.stages.arm.home",
    "a.b.c.d",
    "_target_",
    "hydra",
    "x" * 300,
    "é",
    "1",
)
HYDRAS_OWN = (
    "hydra.searchpath=[pkg://this]", "hydra.searchpath=[file:///nowhere]", "hydra.searchpath=3", "hydra.run.dir=x",
    "hydra.sweeper.address=3", "hydra.sweeper.workers=-1", "hydra.sweeper.params={seed: {a: 1}}", "hydra.launcher=x",
    "hydra/launcher=", "hydra/launcher=basic", "hydra.callbacks.x={_target_: os.getcwd}", "hydra.job.env_copy=[NOPE]",
    "hydra=3", "~hydra", "hydra.job.env_set.A=b", "hydra.job_logging=3", "hydra.output_subdir=x", "hydra.sweeper=3",
)  # fmt: skip
_FUNCTIONS = (
    "range(0,3)", "range(0,1e18)", "choice(a,b)", "glob(*)", "interval(0,1)", "tag(log, interval(1,2))", "int(1.5)",
    "shuffle(1,2)", "str(2)", "float(x)", "json_str({a: 1})", "extend_list(1)", "range(", "cast(1)", "sort(3,1)",
)  # fmt: skip


def keys_of(config: Any, place: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Return the places of all values in a config, collections included."""
    inner = config.items() if isinstance(config, dict) else enumerate(config) if isinstance(config, list) else ()
    return [found for key, item in inner for found in ((*place, key), *keys_of(item, (*place, key)))]


def value(draw: Random, depth: int = 0) -> Any:
    """Return a value as no config needs it, or as one does."""
    kind = draw.random()
    if kind < 0.35:
        return draw.choice(NUMBERS)
    if kind < 0.6:
        return draw.choice(TEXTS)
    if kind < 0.7:
        return draw.choice((None, True, False))
    if kind < 0.75:
        return draw.choice(REFERENCES)
    if kind < 0.78 and depth == 0:
        return nested(draw, draw.choice((5, 25, 40, 120)))
    if kind < 0.8 and depth == 0:
        return [draw.choice(NUMBERS)] * draw.choice((100, 3000))
    if depth > 2:
        return 1.0
    if kind < 0.92:
        return [value(draw, depth + 1) for _ in range(draw.choice((0, 1, 2, 3, 3, 3, 6, 7)))]
    return {
        draw.choice((*UNKNOWN, "macro", "mini", "a", 1, None)): value(draw, depth + 1) for _ in range(draw.randrange(4))
    }


def nested(draw: Random, levels: int) -> Any:
    """Return lists and mappings within each other."""
    found: Any = 1
    for _ in range(levels):
        found = [found] if draw.random() < 0.5 else {"a": found}
    return found


def mutated(draw: Random, config: dict[str, Any]) -> dict[str, Any]:
    """Return a resolved config with a few of its values changed, deleted, moved or added."""
    changed = copy.deepcopy(config)
    for _ in range(draw.choice((1, 1, 1, 2, 3))):
        places = keys_of(changed)
        place = draw.choice(places) if places else ()
        owner: Any = changed
        for key in place[:-1]:
            owner = owner[key]
        kind = draw.random()
        if not place or kind < 0.1:
            changed[draw.choice((*UNKNOWN, 1, None))] = value(draw)
        elif kind < 0.5:
            owner[place[-1]] = tweaked(draw, owner[place[-1]])
        elif kind < 0.55:
            del owner[place[-1]]
        elif kind < 0.65:
            other: Any = changed
            for key in draw.choice(places):
                other = other[key]
            owner[place[-1]] = copy.deepcopy(other)
        elif kind < 0.7 and isinstance(owner, dict):
            owner[draw.choice((*UNKNOWN, 1, None))] = value(draw)
        else:
            owner[place[-1]] = value(draw)
    return changed


def tweaked(draw: Random, found: Any) -> Any:
    """Return a value that could well be meant: a number scaled, in a list one of them; else any."""
    if isinstance(found, bool):
        return not found
    if isinstance(found, int | float):
        return found * draw.choice((-1, 0, 2, 3, 10, 1000, 0.5, 0.1, 1e-3, 1e-6, 1.0001))
    if isinstance(found, list) and found:
        place = draw.randrange(len(found))
        return [tweaked(draw, item) if number == place else item for number, item in enumerate(found)]
    return value(draw)


def override(draw: Random, config: Any, places: list[tuple[Any, ...]], options: list[str]) -> str:
    """Return an override of a config as it could be typed; `options` are such that choose one of a group."""
    kind = draw.random()
    if kind < 0.08:
        return draw.choice(HYDRAS_OWN)
    if kind < 0.3:
        return draw.choice(options)
    if kind < 0.35:
        return "".join(draw.choice(string.printable) for _ in range(draw.randrange(1, 30)))
    if kind < 0.6:
        place, found = draw.choice(places), config
        for key in place:
            found = found[key]
        if not isinstance(found, dict):
            return f"{'.'.join(map(str, place))}={_in_hydras_words(tweaked(draw, found))}"
    key = ".".join(map(str, draw.choice(places))) if draw.random() < 0.85 else draw.choice(UNKNOWN)
    sign = draw.choice(("", "", "", "", "", "+", "++", "~"))
    return f"{sign}{key}={typed(draw)}" if sign != "~" or draw.random() < 0.5 else f"~{key}"


def typed(draw: Random) -> str:
    """Return a value as it could be typed behind an equals sign."""
    kind = draw.random()
    if kind < 0.1:
        return draw.choice(_FUNCTIONS)
    if kind < 0.2:
        return draw.choice(REFERENCES)
    if kind < 0.3:
        return draw.choice(("[" * draw.randrange(200), "[1,", "{a:", "'", '"', "a,b,c", "1,2", "\\", ",", "]", "[[1]]"))
    found = value(draw)
    if isinstance(found, str):
        return draw.choice((found, json.dumps(found), f"'{found}'"))
    return _in_hydras_words(found)


def _in_hydras_words(found: Any) -> str:
    if isinstance(found, dict):
        return "{" + ",".join(f"{key}:{_in_hydras_words(item)}" for key, item in found.items()) + "}"
    if isinstance(found, list):
        return "[" + ",".join(map(_in_hydras_words, found)) + "]"
    return "null" if found is None else json.dumps(found) if isinstance(found, str) else str(found)
