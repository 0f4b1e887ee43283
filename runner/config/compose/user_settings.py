"""User settings: outputs folder, number of workers, and address of a Dask scheduler.

The file is `arm-control-runner/config.yaml` in XDG_CONFIG_HOME or ~/.config. The file has the keys KEYS, as on the
command line. Only the command line and this file may set them; third-party config files may not. The settings change
no result, so that a command has the same meaning on another machine.
"""

import os
import re
from collections.abc import Iterable, Mapping
from functools import lru_cache
from pathlib import Path

from runner.base.errors import ConfigError, nearest
from runner.base.sanitize import quoted

KEYS = ("outputs", "hydra.sweeper.workers", "hydra.sweeper.address")
SAYS_HOW = re.compile(r"(?:^[+~]*|[@:])(?:_global_\.)?(hydra|outputs)(?![^./@:])")
_AXES = "hydra.sweeper.params"


def refuse_settings(given: Iterable[str], path: Path) -> None:
    """Check that a third-party file does not control how or where runs are simulated.

    Args:
        given: Keys or overrides in the file.
        path: The file.

    Raises:
        ConfigError: for `outputs` and every key of `hydra` except the axes of a sweep; names the line.
    """
    for text in given:
        if SAYS_HOW.search(text.partition("=")[0].removeprefix(f"{_AXES}.")):
            raise settings_error(text, path)


def settings_error(text: str, path: Path) -> ConfigError:
    """Return the error for a key or override in a third-party file that controls how or where runs are simulated."""
    from runner.base.bounded_yaml import line_with

    where = f"set it on the command line or in {settings_path()}; allowed here: keys of {_AXES}"
    found = f"{line_with(text, path)}: {quoted(text)}"
    return ConfigError(f"{found} controls how or where runs are simulated, which no file may do; {where}")


def settings_path() -> Path:
    """Return the path of the settings file, which may be missing."""
    base = os.environ.get("XDG_CONFIG_HOME") or "~/.config"
    return Path(os.path.expanduser(base)) / "arm-control-runner" / "config.yaml"  # noqa: PTH111 - never raises


def user_settings() -> Mapping[str, str]:
    """Return the settings by key.

    Raises:
        ConfigError: with file and line, for a file that cannot be read, an unknown key or an invalid value.
    """
    return _read(settings_path())


def user_overrides() -> list[str]:
    """Return the settings as overrides, which precede the typed overrides."""
    return [f"{key}={value}" for key, value in user_settings().items()]


def outputs_dir() -> Path:
    """Return the outputs folder for a command line that names none."""
    return Path(user_settings().get("outputs", "outputs"))


@lru_cache(maxsize=1)
def _read(path: Path) -> Mapping[str, str]:
    if not path.exists():
        return {}
    from runner.base.bounded_yaml import line_with, read_yaml  # for the few who have such a file

    try:
        content = read_yaml(path.read_text(encoding="utf-8"), path) or {}
    except (OSError, ValueError) as error:
        raise ConfigError(f"cannot read {path}: {error}") from None
    for key, value in content.items() if isinstance(content, dict) else [(str(content), None)]:
        if key not in KEYS or not isinstance(value, str | int):
            known = f"{nearest(key, KEYS)}; settings: {', '.join(KEYS)}"
            raise ConfigError(f"{line_with(key, path)}: {quoted({key: value})} is not a setting{known}")
    return {key: os.path.expanduser(str(value)) for key, value in content.items()}  # noqa: PTH111 - of a folder
