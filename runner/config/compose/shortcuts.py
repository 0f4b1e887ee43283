"""Shortcuts in Hydra 1.3 and OmegaConf 2.3, for a third less CPU time of a composition and the same result."""

from functools import cache, lru_cache
from typing import Any

import hydra
import omegaconf
from hydra._internal import defaults_list
from omegaconf import DictConfig, base, grammar_parser

_TEXTS = 4096  # distinct interpolations whose parse trees are kept


@cache
def take_shortcuts() -> None:
    """Let this process parse each interpolation once, and map known choices only for names that refer to them.

    OmegaConf parses an interpolation each time that it is resolved. Hydra converts all choices to a config for each
    file of a defaults list, although only names with an interpolation read it. Other versions remain as they are.
    """
    if omegaconf.__version__.startswith("2.3."):
        parse = lru_cache(maxsize=_TEXTS)(grammar_parser.parse)
        base.parse = grammar_parser.parse = parse  # type: ignore[attr-defined] # imported there
    if hydra.__version__.startswith("1.3."):
        create: Any = defaults_list._create_interpolation_map

        def create_if_read(overrides: Any, defaults: list[Any], self_added: bool) -> DictConfig | None:
            read = any(each.is_interpolation() for each in defaults if not each.is_self())
            return create(overrides, defaults, self_added) if read else None

        defaults_list._create_interpolation_map = create_if_read  # type: ignore[assignment] # nobody reads None
