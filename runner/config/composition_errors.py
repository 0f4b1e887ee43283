"""Turning what Hydra, OmegaConf and YAML say of a bad config into what a user can mend."""

from collections.abc import Sequence
from pathlib import Path

import yaml
from hydra.errors import HydraException, MissingConfigException, OverrideParseException
from omegaconf.errors import OmegaConfBaseException

from runner.config.options import group_options
from runner.errors import ConfigError, nearest

# What Hydra raises for a config that it cannot compose; the ValueError is its answer to `noise=1`.
COMPOSITION_ERRORS = (HydraException, OmegaConfBaseException, yaml.YAMLError, ValueError)


def explain(error: Exception, config_dirs: Sequence[Path] = ()) -> ConfigError:
    """Return the message for what Hydra, OmegaConf or YAML say of a config."""
    if isinstance(error, yaml.YAMLError):
        return _from_yaml_error(error)
    if isinstance(error, MissingConfigException) and error.missing_cfg_file:
        group, _, option = str(error.missing_cfg_file).partition("/")
        known = group_options(group, config_dirs)
        if known:
            return ConfigError([f"{group}: no '{option}'{nearest(option, known)}; known: {', '.join(known)}"])
    if isinstance(error, OverrideParseException):
        return ConfigError([f"'{error.override.removeprefix('++')}' is no override: {str(error).splitlines()[0]}"])
    text = str(error).replace("++", "").split("\nSee https")[0].split("\nTo append")[0]
    return ConfigError([" ".join(text.split())])


def _from_yaml_error(error: yaml.YAMLError) -> ConfigError:
    mark = getattr(error, "problem_mark", None)
    place = f"{mark.name}, line {mark.line + 1}, column {mark.column + 1}" if mark else "a YAML file"
    return ConfigError([f"{place}: {getattr(error, 'problem', None) or error}"])
