"""Messages for errors of Hydra, OmegaConf and YAML."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import yaml
from hydra.errors import HydraException, MissingConfigException, OverrideParseException
from omegaconf.errors import InterpolationKeyError, OmegaConfBaseException

from runner.base.bounded_yaml import explain_yaml
from runner.base.errors import ConfigError, nearest
from runner.base.former_names import explain_value
from runner.base.sanitize import VALUE, one_line, quoted
from runner.config.compose.files import group_options, outside_error
from runner.config.compose.overrides import explain_parser

_AMBIGUOUS = re.compile(r"(?:Ambiguous value for argument|Sweep parameters) '(.*)'(?:$| requires)", re.M)
_OF_HYDRA_1_4 = "Error when parsing index: "  # its first line repeats the override
_LACKING = re.compile(r"Interpolation key '(.*)' not found")
_OUTSIDE = re.compile(r".*Parent traversal .* \('(.*)'\)")  # of Hydra 1.4
_NO_GROUP = re.compile(r".* trying to access (\S+): node `(\S+)` is not a container")
# Exceptions of Hydra for a config that it cannot compose. ValueError and OSError: a file that is not text, or not a
# mapping. RecursionError: OmegaConf, for a value that refers to itself.
COMPOSITION_ERRORS = (HydraException, OmegaConfBaseException, yaml.YAMLError, ValueError, OSError, RecursionError)


def explain_options(error: Exception, chosen: Mapping[str, object], config_dirs: Sequence[Path] = ()) -> ConfigError:
    """Return the same as `explain`; if an option does not exist, with all chosen options that do not exist.

    Args:
        error: The error.
        chosen: The chosen option of each group.
        config_dirs: Config folders of the user.
    """
    first = explain(error, config_dirs)
    if not isinstance(error, MissingConfigException):
        return first
    unknown = [
        _unknown_option(group, option, known)
        for group, option in chosen.items()
        if isinstance(option, str) and option not in (known := group_options(group, config_dirs))
    ]
    return ConfigError([*first.problems, *(text for text in unknown if text not in first.problems)])


def _unknown_option(group: str, option: str, known: Mapping[str, str]) -> str:
    former = explain_value(group, option)
    return (
        f"{group}: {former}" if former else f"{group}: no '{option}'{nearest(option, known)}; known: {', '.join(known)}"
    )


def explain(error: Exception, config_dirs: Sequence[Path] = ()) -> ConfigError:
    """Return an error of Hydra, OmegaConf or YAML as ConfigError with a message for users."""
    if isinstance(error, HydraException) and not str(error) and isinstance(error.__cause__, OmegaConfBaseException):
        error = error.__cause__  # Hydra adds nothing to it
    if isinstance(error, yaml.YAMLError):
        return ConfigError(explain_yaml(error))
    if isinstance(error, MissingConfigException) and error.missing_cfg_file:
        group, _, option = str(error.missing_cfg_file).partition("/")
        known = group_options(group, config_dirs)
        if known or explain_value(group, option):
            return ConfigError(_unknown_option(group, option, known))
    if isinstance(error, OverrideParseException):
        found = one_line(f"'{error.override}'", VALUE)
        text = next(line for line in str(error).splitlines() if not line.startswith(_OF_HYDRA_1_4))
        return ConfigError(f"{found} is not a valid override: {one_line(explain_parser(text), VALUE)}")
    if outside := _OUTSIDE.match(str(error)):
        return outside_error(outside[1])
    missing = _LACKING.match(str(error))
    if isinstance(error, InterpolationKeyError) and error.full_key and missing is not None:
        group = missing[1].partition(".")[0]
        lacks = f"it refers to {missing[1]}, which the chosen {group} lacks"
        return ConfigError(f"{error.full_key}: {lacks}; give a value, or take another {group}")
    if not_group := _NO_GROUP.match(str(error)):
        return ConfigError(f"{not_group[2]}: must be a group of keys, such as {not_group[1]}; found a single value")
    if isinstance(error, OmegaConfBaseException) and error.full_key:
        return ConfigError(f"{error.full_key}: {str(error).splitlines()[0]}")
    if isinstance(error, RecursionError):
        return ConfigError("the config is nested too deeply, or a value refers to itself")
    text = str(error).replace("++", "")  # see `force`
    several = _AMBIGUOUS.match(text)
    if several is not None:
        given = f"{quoted(several[1])} gives several values"
        return ConfigError(f"{given}; `runner -m` sweeps over them; write a list in brackets: KEY=[A,B]")
    return ConfigError(" ".join(text.split("\nSee https")[0].split("\nTo append")[0].split()))
