"""Entries of the command cache, in the user's cache folder with the compiled code, each under its digest."""

import json
from typing import Any

from runner.symbolic import cache

_MOST = 1000  # answers kept
_NAME = "answer-"  # begins the name of each


def recall(key: str) -> Any:
    """Return the answer kept under a key, plain data; None where there is none."""
    found = cache.read(f"{_NAME}{key}")
    return None if found is None else json.loads(found[0])


def keep(key: str, answer: Any) -> None:
    """Keep an answer, plain data; where that fails it is worked out again the next time."""
    place = cache.folder()
    kept = [] if place is None else list(place.glob(f"{_NAME}*"))
    for path in kept if len(kept) >= _MOST else ():
        path.unlink(missing_ok=True)
    cache.write(f"{_NAME}{key}", json.dumps(answer).encode(), {})
