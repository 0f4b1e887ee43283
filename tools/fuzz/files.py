"""YAML files of an experiment, as a careless or a hostile hand could write them, drawn from a seed."""

import json
from random import Random
from typing import Any

from tools.fuzz.grammar import HYDRAS_OWN, REFERENCES, UNKNOWN, tweaked, value

HEADS = (
    "# @package _global_\n",
    "# @package _global_\n# A test\n",
    "",
    "# @package " + "a." * 120 + "a\n",
    "# @package hydra\n",
)
_PIECES = (
    "robot: &r {goal: *r}", "1: 2", "null: 2", "? [a]\n: b", "yes: no", "a: *nope", "a: [", "a: {b: 1", "\ta: 1", "- 1",
    "seed: !!python/object/apply:os.getcwd []", "seed: !!timestamp x", "a: 2001-13-45", "a: " + "9" * 5000, "3",
    "defaults: [3]", "defaults: [nope]", "defaults: {a: b}", "defaults:\n  - /robot: nope",
    "defaults:\n  - override /robot: mini",
    "defaults:\n  - /noise@" + "b." * 60 + "b: none", "a: " + "[" * 20_000, "a: " + "{a: " * 1000, "- " * 2000 + "a",
    "hydra: {searchpath: [pkg://this]}", "hydra: {sweeper: {params: {seed: '0,1'}}}", "outputs: x",
    "hydra: {sweeper: {workers: 0}}", "hydra: 3",
    "hydra: {sweeper: {params: {robot.name: '${x}{oc.env:HOME}'}}}\nx: $", "hydra: {job: {env_copy: [NOPE]}}",
    "hydra: {callbacks: {a: {_target_: os.getcwd}}}", "a: &a [1, 2]\nb: [*a, *a]", "<<: {seed: 1}", "a: ${b}\nb: ${a}",
    "a: &x 1\nb: &x 2\nc: *x", "a: |\n  text\n   more", "'': 1", 'a: "\\x1b]0;pwn\\x07"', "a: \x01",
    "robot: ${robot}", "robot: null", "robot: []", "robot: {stages: {}}", "robot: {stages: {a: {}, b: {}}}",
    "...\n---\na: 1",
)  # fmt: skip


def experiment(draw: Random, config: Any, places: list[tuple[Any, ...]]) -> str:
    """Return the text of an experiment's file over a config, whose places are given."""
    if draw.random() < 0.25:
        return HEADS[0] + _tweaks(draw, config, places)
    pieces = [draw.choice(HEADS) if draw.random() < 0.3 else HEADS[0]]
    for _ in range(draw.choice((1, 1, 2, 3))):
        kind = draw.random()
        if kind < 0.35:
            pieces.append(draw.choice(_PIECES) + "\n")
        elif kind < 0.45:
            pieces.append(draw.choice((_bomb, _doubling, _chain))(draw) + "\n")
        elif kind < 0.5:
            key, _, found = draw.choice(HYDRAS_OWN).partition("=")
            pieces.append(f"{key}: {found}\n")
        else:
            pieces.append(_values(draw, places))
    text = "".join(pieces)
    return _damaged(draw, text) if draw.random() < 0.15 else text


def _tweaks(draw: Random, config: Any, places: list[tuple[Any, ...]]) -> str:
    """Return a key with a value that could well be meant; of a list the whole."""
    names = [key for key in draw.choice(places) if isinstance(key, str)]
    found = config
    for name in names:
        found = found[name]
    return _written(names, tweaked(draw, found))


def _values(draw: Random, places: list[tuple[Any, ...]]) -> str:
    """Return a key with any value."""
    names = [*map(str, draw.choice(places))] if draw.random() < 0.85 else [draw.choice(UNKNOWN)]
    return _written(names, draw.choice(REFERENCES) if draw.random() < 0.2 else value(draw))


def _written(names: list[str], found: Any) -> str:
    """Return a value in YAML, in braces from the root on."""
    text = str(found) if isinstance(found, float | int) else json.dumps(found, default=str)
    first, *rest = names
    return f"{first}: {''.join(f'{{{name}: ' for name in rest)}{text}{'}' * len(rest)}\n"


def _bomb(draw: Random) -> str:
    """Return aliases of aliases."""
    levels, width = draw.choice((2, 4, 9)), draw.choice((2, 9))
    lines = ["a0: &a0 [1]"]
    lines += [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * width)}]" for n in range(1, levels)]
    return "\n".join(lines)


def _doubling(draw: Random) -> str:
    """Return references that stand for twice as much each."""
    levels, as_list = draw.choice((3, 40)), draw.random() < 0.5
    lines = ["d0: x"]
    for n in range(1, levels):
        one = f"'${{d{n - 1}}}'"
        lines.append(f"d{n}: [{one}, {one}]" if as_list else f"d{n}: '${{d{n - 1}}}${{d{n - 1}}}'")
    return "\n".join(lines)


def _chain(draw: Random) -> str:
    """Return references to references."""
    return "\n".join(f"c{n}: ${{c{n + 1}}}" for n in range(draw.choice((3, 100, 2000))))


def _damaged(draw: Random, text: str) -> str:
    """Return a string with some of its characters lost, doubled or changed."""
    for _ in range(draw.randrange(1, 6)):
        place = draw.randrange(len(text) + 1)
        text = (
            text[:place]
            + draw.choice(("", "{", "}", "[", ":", "\n", " ", "\t", "'", "*", "&", "\x00"))
            + text[place + 1 :]
        )
    return text
