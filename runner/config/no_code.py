"""No config runs code: Hydra would make whatever some of its own keys name, and a config folder may be a stranger's."""

import contextlib
from collections.abc import Iterator, Mapping
from typing import Any

from hydra._internal.config_loader_impl import ConfigLoaderImpl
from omegaconf import DictConfig, OmegaConf

from runner.errors import ConfigError

_NO_LOGGING = {"version": 1, "root": None, "disable_existing_loggers": False}
_SWEEPER = {"_target_": "hydra_plugins.runner_sweeper.RunnerSweeper", "_recursive_": False}
_SWEEPER_KEYS = ("workers", "address", "params")


@contextlib.contextmanager
def code_refused() -> Iterator[None]:
    """Let Hydra go on only with configs that name no code, whichever file, package or override they come from."""
    load = ConfigLoaderImpl.load_configuration

    def checked(self: ConfigLoaderImpl, *args: Any, **options: Any) -> DictConfig:
        config = load(self, *args, **options)
        refuse_code(config)
        return config

    ConfigLoaderImpl.load_configuration = checked  # type: ignore[method-assign]
    try:
        yield
    finally:
        ConfigLoaderImpl.load_configuration = load  # type: ignore[method-assign]


def refuse_code(config: DictConfig) -> None:
    """Check the keys of Hydra's own by which it runs code.

    These make objects (callbacks, sweeper), set what Python starts with (job.env_set) or name classes (logging).

    Raises:
        ConfigError: for each that holds something else than ours.
    """
    bad = [key for key in ("callbacks", "job.env_set") if OmegaConf.select(config.hydra, key)]
    bad += [key for key in ("job_logging", "hydra_logging") if _plain(config.hydra[key]) != _NO_LOGGING]
    sweeper = _plain(config.hydra.sweeper)
    params = sweeper.get("params") or {}
    ours = {key: value for key, value in sweeper.items() if key not in _SWEEPER_KEYS} == _SWEEPER
    if not ours or not isinstance(params, Mapping) or any(isinstance(value, Mapping) for value in params.values()):
        bad.append("sweeper")
    if bad:
        raise ConfigError(
            f"hydra.{key}: a config cannot name code, nor change what starts it; --plugin names code, and free are "
            "hydra.sweeper.workers, .address and .params, whose values are texts or numbers"
            for key in bad
        )


def _plain(node: Any) -> Any:
    return OmegaConf.to_container(node, resolve=True) if OmegaConf.is_config(node) else node
