"""List the available robots, controllers, metrics and other options.

Example: runner list controllers
"""

import re
from argparse import Namespace
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

from runner.base.errors import RunnerError, unknown
from runner.base.former_names import TOPICS as FORMER_TOPICS
from runner.base.sanitize import escaped, one_line
from runner.cli.arguments import Parser
from runner.cli.commands import Topic, guests_topics, installed_topics
from runner.config.compose.files import group_options, groups


def add_arguments(parser: Parser) -> None:
    """Add the arguments."""
    parser.add_argument("topic", nargs="?", metavar="TOPIC", help=", ".join(TOPICS))
    parser.add_shared("config_dir")


def run(options: Namespace) -> int:
    """Print one topic with descriptions, or an overview of all."""
    own, topics = options.config_dir, {**TOPICS, **installed_topics()}
    if options.topic is None:
        _print_overview(topics, own)
    elif options.topic in topics:
        _print_table(topics[options.topic](own))
    elif options.topic in FORMER_TOPICS:
        raise RunnerError(f"{options.topic} is now called {FORMER_TOPICS[options.topic]}.")
    else:
        raise RunnerError(unknown("topic", options.topic, topics, "list"))
    return 0


def _topic(group: str) -> str:
    """Return the plural of a group's name."""
    if group.endswith("y"):
        return f"{group[:-1]}ies"
    return group if group.endswith(("s", "noise")) else f"{group}{'es' if group.endswith('ch') else 's'}"


def _list_plants(config_dirs: Sequence[Path]) -> dict[str, str]:
    return group_options("plant", config_dirs)


def _list_metrics(_: Sequence[Path]) -> dict[str, str]:
    from runner.plugins.metric_units import families  # numpy, which the other topics answer without

    found: dict[str, str] = {}
    for family in families():
        meanings = _read_bullets(family.evaluate.__doc__ or "")
        found |= {name: f"[{unit}] {meanings.get(name, '')}".rstrip() for name, unit in family.UNITS.items()}
    return found


def _read_bullets(docstring: str) -> dict[str, str]:
    """Return the meaning of each name in a docstring's bullets `- name, name: meaning; more`, up to the semicolon."""
    meanings = {}
    for names, meaning in re.findall(r"^\s*- ([\w, ]+): (.+?)(?:;|\.?\s*(?=^\s*- |\Z))", docstring, re.M | re.S):
        for name in names.split(","):
            meanings[name.strip()] = " ".join(meaning.split())
    return meanings


def _list_baselines(_: Sequence[Path]) -> dict[str, str]:
    from runner.store.baselines import shipped_baselines

    return shipped_baselines()


TOPICS: Mapping[str, Topic] = {
    **{_topic(group): partial(group_options, group) for group in groups()},
    "plants": _list_plants,
    "metrics": _list_metrics,
    "baselines": _list_baselines,
    **guests_topics(),
}
"""Topics: each has a function that returns names with one-line descriptions."""


def _print_overview(topics: Mapping[str, Topic], own: Sequence[Path]) -> None:
    import shutil
    import textwrap

    width = shutil.get_terminal_size().columns
    for topic, entries in topics.items():
        names = escaped(", ".join(entries(own))) or "none"
        indent = " " * 15
        print(textwrap.fill(f"{topic:<13}  {names}", width, subsequent_indent=indent, break_on_hyphens=False))
    print("\n`runner list TOPIC` describes each; an option is chosen by its group, as in robot=macro")


def _print_table(entries: Mapping[str, str]) -> None:
    width = max(map(len, entries), default=0)
    for name, description in entries.items():
        print(one_line(f"{name:<{width}}  {description}".rstrip()))
