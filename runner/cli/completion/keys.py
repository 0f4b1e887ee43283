"""Keys of a config and names of metrics, for completion; both are kept in the cache."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from runner.base.dotted_keys import dotted, leaves
from runner.cli.completion.basis import basis
from runner.symbolic import cache


def keys(overrides: Sequence[str], config_dirs: Sequence[Path], word: str, root: str) -> Iterator[str]:
    """Yield the keys that complete a word up to the next dot, and the value of a whole key: `controller.period=0.01`.

    Args:
        overrides: The overrides typed before; Hydra composes the config that they give.
        config_dirs: The user's config folders.
        word: The typed word, without a sign before the key.
        root: File of conf/ that the overrides change.
    """
    key, given, _ = word.partition("=")
    whole = [each for each in overrides if "=" in each]
    values: Mapping[str, str | None] = _cached(
        ["keys of", root, *whole], config_dirs, lambda: dict(_compose(whole, config_dirs, root))
    )
    if given:
        if values.get(key) is not None:
            yield f"{key}={values[key]}"
        return
    place = key.rfind(".") + 1
    for found in values:
        if found.startswith(key):
            name, dot, _ = found[place:].partition(".")
            yield f"{key[:place]}{name}{dot or '='}"


def metric_names() -> Iterable[str]:
    """Return the names of the built-in metrics."""

    def read() -> list[str]:
        from runner.cli.list import TOPICS

        return [*TOPICS["metrics"]([])]

    names: list[str] = _cached(["metrics"], [], read)
    return names


def _cached(question: Sequence[str], config_dirs: Sequence[Path], answer: Callable[[], Any]) -> Any:
    """Return the answer to a question from the cache; it is computed and kept if the cache lacks it."""
    key = basis(question, config_dirs)
    found = None if key is None else cache.read_answer(key)
    if found is None:
        found = answer()
        if key is not None:
            cache.write_answer(key, found)
    return found


def _compose(overrides: Sequence[str], config_dirs: Sequence[Path], root: str) -> Iterator[tuple[str, str | None]]:
    from omegaconf import OmegaConf
    from omegaconf.errors import OmegaConfBaseException

    from runner.config.compose.composer import Composer

    config = Composer(config_dirs, root).load(overrides)
    ours: Any = OmegaConf.to_container(config, resolve=False)
    del ours["hydra"]
    for key, value in ((dotted(place), value) for place, value in leaves(ours)):
        try:
            yield key, _typed(OmegaConf.select(config, key) if "${" in str(value) else value)
        except OmegaConfBaseException:  # it refers to a key that does not exist yet
            yield key, None


def _typed(value: Any) -> str | None:
    """Return a value as it is typed in an override."""
    if isinstance(value, bool):
        return str(value).lower()
    return str(value) if isinstance(value, int | float | str) else None
