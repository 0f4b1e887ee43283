"""JSON decoder with a limit on nesting, checked before any object is built.

The decoder of Python descends once for each level. The depth at which it fails, and its message, depend on the version
of Python and on the size of the stack.
"""

import json
import re
from typing import Any

DEPTH = 100
"""Largest number of nested lists and objects; a value of a config has at most 30."""

_ESCAPED = re.compile(rb"\\.", re.DOTALL)
_STRING = re.compile(rb'"[^"]*("|\Z)')
_OTHERS = bytes(set(range(256)) - set(b'"[]{}'))
_AS_LISTS = bytes.maketrans(b"{}", b"[]")


def decode_json(content: str | bytes) -> Any:
    """Return the value of a JSON text.

    Raises:
        ValueError: if the text is not JSON, or is nested deeper than DEPTH.
    """
    encoded = content.encode(errors="replace") if isinstance(content, str) else content
    if _is_deeper(encoded, DEPTH):
        raise ValueError(f"nested deeper than {DEPTH} levels")
    return json.loads(content)


def _is_deeper(content: bytes, depth: int) -> bool:
    """Return True if the brackets of a JSON text are nested deeper than a depth; those in strings do not count."""
    if b"\\" in content:
        content = _ESCAPED.sub(b"", content)
    left = _STRING.sub(b"", content.translate(_AS_LISTS, _OTHERS).replace(b'""', b""))
    for _ in range(depth):  # each pass removes the innermost level
        if b"[]" not in left:
            break
        left = left.replace(b"[]", b"")
    return b"[]" in left or left.count(b"[") > depth
