"""Completion of config keys; Hydra composes the config once for each line."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from runner.cli.completion.basis import basis
from runner.cli.completion.line import Line
from runner.symbolic import cache


def keys(line: Line, word: str, root: str) -> Iterator[str]:
    """Yield the keys that complete a word up to the next dot, and the value of a whole key: `controller.period=0.01`.

    Args:
        line: The line; its overrides choose what there are keys of.
        word: The typed word, without a sign before the key.
        root: Name of the file in conf/ that the config hangs on.
    """
    key, given, _ = word.partition("=")
    values = _values(line, root)
    if given:
        if values.get(key) is not None:
            yield f"{key}={values[key]}"
        return
    place = key.rfind(".") + 1
    for found in values:
        if found.startswith(key):
            name, dot, _ = found[place:].partition(".")
            yield f"{key[:place]}{name}{dot or '='}"


def _values(line: Line, root: str) -> Mapping[str, str | None]:
    """Return the value of each key as text by its dotted name; None for one without a value that can be typed."""
    overrides = [each for each in line.words if "=" in each and not each.startswith("-")]
    known = basis(["keys of", root, *overrides], line.config_dirs)
    kept = None if known is None else cache.read_answer(known)
    if not isinstance(kept, dict):
        kept = dict(_compose(line, overrides, root))
        if known is not None:
            cache.write_answer(known, kept)
    values: Mapping[str, str | None] = kept
    return values


def _compose(line: Line, overrides: Sequence[str], root: str) -> Iterator[tuple[str, str | None]]:
    from omegaconf import OmegaConf
    from omegaconf.errors import OmegaConfBaseException

    from runner.config.compose.hydra_config import hydra_config
    from runner.config.compose.overrides import force

    config = hydra_config(force(overrides), line.config_dirs, root)
    ours: Any = OmegaConf.to_container(config, resolve=False)
    del ours["hydra"]
    for key, value in _leaves(ours, ""):
        try:
            yield key, _typed(OmegaConf.select(config, key) if "${" in str(value) else value)
        except OmegaConfBaseException:  # it refers to what is not chosen yet
            yield key, None


def _leaves(value: Any, key: str) -> Iterator[tuple[str, Any]]:
    inner = value if isinstance(value, Mapping) else dict(enumerate(value)) if isinstance(value, list) else {}
    for name, each in inner.items():
        yield from _leaves(each, f"{key}.{name}" if key else str(name))
    if not inner:
        yield key, value


def _typed(value: Any) -> str | None:
    """Return a value as it is typed in an override."""
    if isinstance(value, bool):
        return str(value).lower()
    return str(value) if isinstance(value, int | float | str) else None
