"""Turning what Hydra, OmegaConf and YAML say of a bad config into what a user can mend."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import yaml
from hydra.errors import HydraException, MissingConfigException, OverrideParseException
from omegaconf import OmegaConf
from omegaconf.errors import OmegaConfBaseException

from runner.config.options import group_options
from runner.errors import ConfigError, nearest

# What Hydra raises for a config that it cannot compose; the last two for a file that is no text, or no mapping.
COMPOSITION_ERRORS = (HydraException, OmegaConfBaseException, yaml.YAMLError, ValueError, OSError)


def explain(error: Exception, config_dirs: Sequence[Path] = ()) -> ConfigError:
    """Return the message for what Hydra, OmegaConf or YAML say of a config."""
    if isinstance(error, yaml.YAMLError):
        return ConfigError([explain_yaml(error)])
    if isinstance(error, UnicodeDecodeError | OSError) and not isinstance(error, HydraException):
        unreadable = [problem for folder in config_dirs for problem in _unreadable(folder)]
        if unreadable:
            return ConfigError(unreadable)
    if isinstance(error, MissingConfigException) and error.missing_cfg_file:
        group, _, option = str(error.missing_cfg_file).partition("/")
        known = group_options(group, config_dirs)
        if known:
            return ConfigError([f"{group}: no '{option}'{nearest(option, known)}; known: {', '.join(known)}"])
    if isinstance(error, OverrideParseException):
        return ConfigError([f"'{error.override.removeprefix('++')}' is no override: {str(error).splitlines()[0]}"])
    if isinstance(error, OmegaConfBaseException) and error.full_key:
        return ConfigError([f"{error.full_key}: {str(error).splitlines()[0]}"])
    text = str(error).replace("++", "").split("\nSee https")[0].split("\nTo append")[0]
    return ConfigError([" ".join(text.split())])


def explain_yaml(error: yaml.YAMLError, place: Path | None = None) -> str:
    """Return file, line, column and problem of what is no YAML; `place` is for a text without a file name."""
    mark = getattr(error, "problem_mark", None)
    where = place or (mark and mark.name) or "a YAML file"
    line = f", line {mark.line + 1}, column {mark.column + 1}" if mark else ""
    return f"{where}{line}: {getattr(error, 'problem', None) or error}"


def _unreadable(folder: Path) -> Iterator[str]:
    for path in sorted(folder.resolve().rglob("*.yaml")):
        try:
            OmegaConf.load(path)
        except yaml.YAMLError as error:
            yield explain_yaml(error)
        except UnicodeDecodeError as error:
            yield f"{path}: is no text: {error}"
        except OSError as error:
            yield f"{path}: {error.strerror or 'holds no mapping of keys'}"
