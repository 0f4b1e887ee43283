"""Overrides of one stage, such as `controller.period.macro=0.03`, merged with the values of the other stages."""

import re
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path

from omegaconf import DictConfig, OmegaConf

from runner.base.bounded_yaml import CONFIG, read_yaml
from runner.base.paths import conf_dir


def complete_stages(config: DictConfig, choices: Mapping[str, str], config_dirs: Sequence[Path]) -> None:
    """Complete mappings that name some stages with what their group's file takes from elsewhere for the others.

    A group's file says `period: ${robot.period}`. An override of one stage replaces that reference by a mapping that
    has this stage alone; here the others come back, so that a mapping override merges.

    Args:
        config: The composed config, completed in place.
        choices: The option chosen in each group.
        config_dirs: Config folders of the user's, searched before ours.
    """
    for group, option in choices.items():
        for key, reference in _references(group, option, config_dirs):
            node = config.get(group)
            if not isinstance(node, DictConfig) or OmegaConf.is_interpolation(node, key) or key not in node:
                continue
            given, default = node[key], OmegaConf.select(config, reference)
            if isinstance(given, DictConfig) and isinstance(default, DictConfig):
                node[key] = {**default, **given}


def _references(group: str, option: str, config_dirs: Sequence[Path]) -> list[tuple[str, str]]:
    """Return key and target of each value that is one reference, in the file of an option."""
    for folder in (*config_dirs, conf_dir()):
        path = folder / group / f"{option}.yaml"
        if path.is_file():
            return _references_of(path.read_text(), path)
    return []


@lru_cache(maxsize=256)
def _references_of(text: str, path: Path) -> list[tuple[str, str]]:
    content = read_yaml(text, path, CONFIG)
    found = [
        (key, re.fullmatch(r"\$\{([\w.]+)\}", value))
        for key, value in (content.items() if isinstance(content, Mapping) else ())
        if isinstance(value, str)
    ]
    return [(str(key), match[1]) for key, match in found if match is not None]
