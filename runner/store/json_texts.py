"""JSON encoder for many mappings with common parts, such as the configs of a sweep's runs."""

import json
from collections.abc import Mapping
from typing import Any

_encode = json.JSONEncoder().encode
encode_finite = json.JSONEncoder(allow_nan=False).encode
"""Return the JSON text of a value, as `json.dumps` does.

Raises:
    ValueError: for a number that is not finite.
"""


class JsonTexts:
    """Texts as `json.dumps` gives them; what stands below the root and comes again is encoded once.

    It is known again as the same object under the same key, and must not be changed in between.
    """

    def __init__(self) -> None:
        self._known: dict[tuple[str, int], str] = {}
        self._kept: list[object] = []  # so that no other object takes the place of one in memory

    def of(self, content: Mapping[str, Any]) -> str:
        """Return the text of a mapping."""
        known = self._known.get
        entries = [known((key, id(value))) or self._entry(key, value) for key, value in content.items()]
        return "{" + ", ".join(entries) + "}"

    def _entry(self, key: str, value: object) -> str:
        entry = f"{_encode(key)}: {_encode(value)}"
        self._kept.append(value)
        self._known[key, id(value)] = entry
        return entry
