"""JSON encoder for many mappings with common parts, such as the configs of a sweep's runs."""

import json
from collections.abc import Mapping
from typing import Any

_encode = json.JSONEncoder().encode
encode_finite = json.JSONEncoder(allow_nan=False).encode
"""Return the JSON text of a value, as `json.dumps` does.

Raises:
    ValueError: if a number is not finite.
"""


class JsonTexts:
    """Encoder with the output of `json.dumps` that encodes a repeated value below the root only once.

    A value is recognized as the same object under the same key. It must not be changed between calls.
    """

    def __init__(self) -> None:
        self._known: dict[tuple[str, int], str] = {}
        self._kept: list[object] = []  # keeps the objects alive, so that their ids stay unique

    def of(self, content: Mapping[str, Any]) -> str:
        """Return the JSON of a mapping."""
        known = self._known.get
        entries = [known((key, id(value))) or self._entry(key, value) for key, value in content.items()]
        return "{" + ", ".join(entries) + "}"

    def _entry(self, key: str, value: object) -> str:
        entry = f"{_encode(key)}: {_encode(value)}"
        self._kept.append(value)
        self._known[key, id(value)] = entry
        return entry
