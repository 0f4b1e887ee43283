"""Run hash: the digest that identifies a run."""

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from typing import Any

from runner.assembly.versions import engine_versions
from runner.base.memory import Memory
from runner.plugins.discovery import GROUPS, added_parts, source_files
from runner.store.names import Names
from runner.store.physics import content_digest, physics_digest
from runner.store.seal import simulated_part

_MEMORY = Memory(4096)  # JSON strings of config groups, and the kinds that the groups name
_PLACES = 12  # bytes of the digest in a name


def run_hash(resolved: Mapping[str, Any], urdf: str) -> str:
    """Return the name of a run's folder: SHA-256 over everything that determines the result.

    The digest covers the resolved config (without outputs, sweep, limits, caveats, spec, and preset, whose values are
    already in the groups), the URDF, the content of the physics and of the plug-ins that the run uses, and the versions
    of the plant's engine, of Pinocchio and of the evaluator of compiled laws. It is taken over JSON with sorted keys.
    The JSON of a group is cached for runs that share the group, so a group must not be changed afterwards.
    """
    return hashlib.sha256("".join(_content(resolved, urdf)).encode()).digest()[:_PLACES].hex()


def run_hashes(resolved: Mapping[str, Any], urdf: str, seeds: Sequence[int]) -> Names:
    """Return the names of runs that differ only in their seed; see run_hash."""
    texts = list(_content(resolved, urdf))
    place = sorted(simulated_part(resolved)).index("seed")
    start, end = texts[place].removesuffix(json_text(resolved["seed"])), "".join(texts[place + 1 :]).encode()
    begun = hashlib.sha256("".join([*texts[:place], start]).encode())

    def packed(seed: int) -> bytes:
        digest = begun.copy()
        digest.update(b"%d%b" % (seed, end))
        return digest.digest()[:_PLACES]

    return Names.unpacked(b"".join(map(packed, seeds)))


def _content(resolved: Mapping[str, Any], urdf: str) -> Iterator[str]:
    """Yield the hashed JSON with sorted keys in parts, one part for each key of the config."""
    config = simulated_part(resolved)
    before = '{"config": {'
    for key in sorted(config):
        yield f"{before}{_key_text(key)}: {json_text(config[key])}"
        before = ", "
    yield "}" if config else f"{before}}}"
    parts = _parts_digest(tuple(sorted(_parts(resolved))))
    engines = engine_versions(str(resolved.get("plant", {}).get("kind", "none")))
    yield f', "engines": {json_text(engines)}, "parts": "{parts}", "source": "{physics_digest()}"'
    yield f', "urdf": {_MEMORY.recall(_sorted_text, urdf)}}}'


def json_text(value: object) -> str:
    """Return a config value as JSON with sorted keys; that of a group is cached, so the group must not be changed."""
    return _MEMORY.recall(_sorted_text, value) if isinstance(value, Mapping) else _sorted_text(value)


_sorted_text = json.JSONEncoder(sort_keys=True).encode
_key_text = lru_cache(maxsize=256)(_sorted_text)


def _parts(resolved: Mapping[str, Any]) -> set[tuple[str, str]]:
    """Return name and module of the plug-ins that a run uses: those whose kind the config names, and all metrics."""
    points = [(group, point) for group in GROUPS if group != "section" for point in added_parts(group)]
    if not points:
        return set()
    kinds = {str(resolved["kind"])} if "kind" in resolved else set()
    for value in resolved.values():
        if isinstance(value, Mapping):
            kinds |= _MEMORY.recall(_kinds, value)
    return {(point.name, point.value) for group, point in points if group == "metric" or point.name in kinds}


def _kinds(group: Mapping[str, Any]) -> frozenset[str]:
    """Return every `kind` in a group of a config, at any depth."""
    inner = (_kinds(value) for key, value in group.items() if isinstance(value, Mapping) and key != "kind")
    return frozenset([str(group["kind"])] if "kind" in group else []).union(*inner)


@lru_cache(maxsize=16)
def _parts_digest(parts: tuple[tuple[str, str], ...]) -> str:
    """Return a digest of the content of plug-ins, given by name and module, at their first use."""
    files = [(name, path) for name, module in parts for path in source_files(module)]
    sources = {f"{number} {name} {path.name}": path.read_bytes() for number, (name, path) in enumerate(files)}
    return content_digest(sources, {name: name for name in sources})
