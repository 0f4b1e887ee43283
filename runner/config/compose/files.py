"""Config files: options of the config groups, and the settings of the user.

The user's file is `arm-control-runner/config.yaml` in XDG_CONFIG_HOME or ~/.config. The file has the keys KEYS, as on
the command line: outputs folder, number of workers, and address of a Dask scheduler. Only the command line and this
file may set them; third-party config files may not. The settings change no result, so that a command has the same
meaning on another machine.
"""

import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from itertools import islice
from pathlib import Path

from runner.base.errors import ConfigError, nearest
from runner.base.paths import STUDY_FILE, conf_dir, studies_dir, studies_with
from runner.base.sanitize import quoted
from runner.plugins.discovery import functions_in_use

_HEAD = 10_000  # characters to search for the first comment of a file


def groups(config_dirs: Sequence[Path] = ()) -> list[str]:
    """Return the sorted names of the config groups, without Hydra's own groups."""
    found = {
        entry.name
        for folder in (*config_dirs, conf_dir())
        if folder.is_dir()
        for entry in folder.iterdir()
        if entry.is_dir()
    }
    return sorted(found - {"hydra"})


def group_options(group: str, config_dirs: Sequence[Path] = ()) -> dict[str, str]:
    """Return the options of a group with their descriptions, sorted by name.

    Args:
        group: Name of the group, such as "robot".
        config_dirs: Config folders of the user.

    Returns:
        Name of each option, such as "thesis/figure_3_5", and the first comment in its file except directives; of a
        function the first line of its docstring.
    """
    found: dict[str, str] = {}
    for folder in (conf_dir(), *built_in_studies(group), *config_dirs):
        files = described_files(folder / group)
        found |= {option_in(folder, group, name): description for name, description in files.items()}
    if group == "controller" and functions_in_use(group):
        from runner.controllers import CONTROLLERS  # for few commands

        found |= {
            kind: (module.__doc__ or "").partition("\n")[0] for kind, module in CONTROLLERS.of_functions().items()
        }
    return dict(sorted(found.items()))


@lru_cache(maxsize=8)
def built_in_studies(group: str) -> Sequence[Path]:
    """Return the folders of the built-in studies whose options of a group are built-in: experiments and controllers."""
    return [studies_dir() / name for name in studies_with(group)] if group in STUDY_GROUPS else []


def state_of(folders: Iterable[Path], most: int) -> tuple[tuple[str, int, int], ...] | None:
    """Return path, time of change in ns and size of all files in some folders; of subfolders the path, and zeros.

    Args:
        folders: The folders.
        most: Largest number of files and subfolders.

    Returns:
        None if there are more, or a folder or file does not exist.
    """
    try:
        found = tuple(islice((each for folder in folders for each in _below(folder)), most + 1))
    except OSError:
        return None
    return found if len(found) <= most else None


def _below(folder: Path | str) -> Iterator[tuple[str, int, int]]:
    with os.scandir(folder) as entries:
        for entry in sorted(entries, key=lambda entry: entry.name):
            if not entry.is_dir():
                status = entry.stat()
                yield entry.path, status.st_mtime_ns, status.st_size
            elif entry.name != "__pycache__":
                yield entry.path, 0, 0
                yield from _below(entry.path)


def described_files(root: Path) -> dict[str, str]:
    """Return the YAML files below a folder by name without suffix, each with its first comment, sorted by name."""
    files = sorted(path for path in root.rglob("*.yaml") if path.is_file())
    return {path.relative_to(root).with_suffix("").as_posix(): _first_comment(path) for path in files}


def _first_comment(path: Path) -> str:
    with path.open(errors="replace") as file:
        for line in file.read(_HEAD).splitlines():
            text = line.strip()
            if text.startswith("#") and not text.startswith(("# @package", "# runner ")):
                return text.lstrip("# ")
    return ""


_GROUP = "experiment"
STUDY_GROUPS = (_GROUP, "controller")
"""Groups in which a built-in study adds options for all; its robots are its own."""


def place_in(folder: Path, config_path: str) -> Path:
    """Return the path of a config in a folder; that of the experiment NAME/x is experiment/x in the study NAME.

    The built-in studies belong to conf/; the options of their other groups have names of no study.
    """
    group, _, name = config_path.partition("/")
    study, _, rest = name.partition("/")
    home = studies_dir() / study if folder == conf_dir() and study else folder
    if group == _GROUP and study and option_in(home, group, rest) == name:
        return home / group / rest
    others = built_in_studies(group) if folder == conf_dir() and group != _GROUP and name else ()
    return next((path for own in others if (path := own / config_path).is_file()), folder / config_path)


def option_in(folder: Path, group: str, name: str) -> str:
    """Return the option name of a file in a folder: NAME/x for the experiment x of the study NAME."""
    own = folder.resolve().name
    named = group == _GROUP and (folder / STUDY_FILE).is_file() and not (folder / group / own).is_dir()
    return f"{own}/{name}" if named else name


def outside_error(name: str) -> ConfigError:
    """Return the error for the name of a config that leads out of its folder."""
    named = f"{quoted(name)}: not a config in a folder; a defaults list or an override names it"
    return ConfigError(f"{named}; allowed: names without '..' and '/' in front")


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


def user_overrides() -> list[str]:
    """Return the settings as overrides, which precede the typed overrides.

    Raises:
        ConfigError: with file and line, for a file that cannot be read, an unknown key or an invalid value.
    """
    given = _read(settings_path())
    return [outputs_override(value) if key == "outputs" else f"{key}={value}" for key, value in given.items()]


def outputs_override(folder: Path | str) -> str:
    """Return the override that names an outputs folder; it is quoted, because a name may contain any sign.

    Raises:
        ConfigError: for a name with `${`, which begins a reference.
    """
    from hydra.core.override_parser.types import Quote, QuotedString

    if "${" in str(folder):
        raise ConfigError(f"outputs: '${{' begins a reference ({quoted(str(folder))}). Choose a name without it")
    return f"outputs={QuotedString(str(folder), Quote.single).with_quotes()}"


def outputs_dir() -> Path:
    """Return the outputs folder for a command line that names none; see user_overrides for errors."""
    return Path(_read(settings_path()).get("outputs", "outputs"))


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
