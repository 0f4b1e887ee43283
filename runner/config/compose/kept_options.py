"""Composed options kept on disk: what Hydra makes of chosen options, as plain data.

Hydra takes a third of the time of a short run to compose the options of a command line. An entry is plain JSON, under a
key of the options and of path, time and size of every config file. It is written only if the config that is made from
it equals the one composed, node by node, with types and flags.
"""

import hashlib
import json
from collections.abc import Mapping, Sequence
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

from runner.base.cache import read_answer, write_answer
from runner.base.paths import conf_dir
from runner.config.compose.files import STUDY_GROUPS, built_in_studies, state_of

if TYPE_CHECKING:
    from omegaconf import DictConfig

RUN = "RunMode.RUN"
"""Hydra's mode for one run, as text."""
_FLAGS = ("struct", "readonly")
_MOST = 1000  # files and folders in the config folders; if there are more, Hydra composes each time


def files_of(config_dirs: Sequence[Path]) -> tuple[tuple[str, int, int], ...] | None:
    """Return the state of every config file, on which composed options depend; None for too many files."""
    studies = [folder / group for group in STUDY_GROUPS for folder in built_in_studies(group)]
    return state_of((conf_dir(), *studies, *config_dirs), _MOST)


def key_of(*parts: object) -> str:
    """Return the key of composed options: of everything that decides them, and of the code that composes."""
    state = [version("hydra-core"), version("omegaconf"), *map(str, parts)]
    state += [path.read_text(encoding="utf-8") for path in sorted(Path(__file__).parent.glob("*.py"))]
    return f"options-{hashlib.sha256(json.dumps(state).encode()).hexdigest()}"


def read_content(key: str) -> dict[str, Any] | None:
    """Return the composed options of a key as plain data; None if there are none."""
    content = read_answer(key)
    return content if isinstance(content, dict) else None


def read_options(key: str) -> "DictConfig | None":
    """Return the composed options of a key; None if there are none, or the entry is damaged."""
    content = read_content(key)
    try:
        return None if content is None else _restored(content)
    except Exception:  # an entry of another kind; the options are composed again
        return None


def write_options(key: str, config: "DictConfig") -> None:
    """Keep composed options if plain data restores them."""
    from omegaconf import OmegaConf

    content: Any = OmegaConf.to_container(config, resolve=False, enum_to_str=True)
    try:
        kept = json.loads(json.dumps(content, allow_nan=False))
        if _alike(_restored(kept), config):
            write_answer(key, kept)
    except (TypeError, ValueError, RecursionError):
        return


def _restored(content: Mapping[str, Any]) -> "DictConfig":
    """Return a config from plain data; Hydra's own node has the types of Hydra's classes."""
    from hydra.conf import HydraConf
    from omegaconf import OmegaConf

    config = OmegaConf.create({name: None if name == "hydra" else value for name, value in content.items()})
    hydra = OmegaConf.structured(HydraConf)
    launcher = import_module("hydra._internal.core_plugins.basic_launcher")  # Hydra may import its plug-ins anew
    hydra.launcher = OmegaConf.structured(launcher.BasicLauncherConf)
    hydra.sweeper, hydra.runtime.config_sources = {}, []
    OmegaConf.set_readonly(hydra, False)
    OmegaConf.set_struct(hydra, False)
    hydra.merge_with(content["hydra"])
    hydra._set_flag("struct", None)
    _order(hydra, content["hydra"])
    config.hydra = hydra
    OmegaConf.set_struct(config, True)
    return config


def _order(node: "DictConfig", content: Mapping[str, Any]) -> None:
    """Put the keys of Hydra's node into the order of the data, which may lack some of them."""
    nodes = node.__dict__["_content"]
    for name, value in content.items():
        if isinstance(value, Mapping):
            _order(nodes[name], value)
    node.__dict__["_content"] = {name: nodes[name] for name in content}


def _alike(one: Any, other: Any) -> bool:
    """Return True if two nodes have the same classes, types, flags, keys in the same order, and values."""
    from omegaconf import DictConfig, ListConfig
    from omegaconf.base import Container

    if type(one) is not type(other) or _about(one) != _about(other):
        return False
    if not isinstance(one, Container):
        return type(one._value()) is type(other._value()) and bool(one._value() == other._value())
    mine, its = one.__dict__["_content"], other.__dict__["_content"]
    if isinstance(one, DictConfig) and isinstance(mine, dict) and isinstance(its, dict):
        return [*mine] == [*its] and all(_alike(mine[name], its[name]) for name in mine)
    if isinstance(one, ListConfig) and isinstance(mine, list) and isinstance(its, list):
        return len(mine) == len(its) and all(map(_alike, mine, its))
    return bool(mine == its)


def _about(node: Any) -> tuple[object, ...]:
    about = node._metadata
    flags = {name: value for name in _FLAGS if (value := node._get_node_flag(name)) is not None}
    types = about.object_type, about.ref_type, getattr(about, "element_type", None)
    return *map(str, types), about.optional, about.key, flags  # a class of a plug-in of Hydra exists several times
