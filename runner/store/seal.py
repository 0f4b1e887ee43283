"""Digests and JSON of stored files.

A damaged file is detected when it is read, and never used. A digest detects accidents: a flipped bit, half a file, an
edit. It does not detect forgery, because anyone can compute a new digest.
"""

import hashlib
import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from runner.base.errors import StoreError
from runner.base.limits import RECORD, RECORD_VALUES, ExcessError

SCHEMA = 3
"""Schema of every stored file; files of another schema are rejected."""

_BLANK = "0" * 64
_DIGEST = re.compile(rb'"digest": "([0-9a-f]{64})"')
_LINE_HEX = 32

_encode = json.JSONEncoder().encode
encode_finite = json.JSONEncoder(allow_nan=False).encode
"""Return the JSON text of a value, as `json.dumps` does.

Raises:
    ValueError: if a number is not finite.
"""


class DamagedError(StoreError):
    """A stored file that differs from what was written."""


class SchemaError(StoreError):
    """A stored file of another schema, written by another version.

    Args:
        path: The file.
        schema: Its schema.
    """

    def __init__(self, path: Path, schema: object) -> None:
        super().__init__(
            f"cannot read {path}: it has schema {schema}, and this version reads schema {SCHEMA}; make it again in "
            "another folder, as in outputs=FOLDER"
        )


def digest(content: bytes) -> str:
    """Return the digest of a file's content: SHA-256."""
    return hashlib.sha256(content).hexdigest()


def sealed_json(content: Mapping[str, Any]) -> bytes:
    """Return content as JSON, with its schema and digest first; see `read_json`."""
    return seal_text(json.dumps({**head(), **content}, indent=1, allow_nan=False) + "\n")


def head() -> dict[str, Any]:
    """Return the first entries of sealed JSON: the schema, and a placeholder for the digest."""
    return {"schema": SCHEMA, "digest": _BLANK}


def seal_text(text: str) -> bytes:
    """Return JSON with its placeholder replaced by a digest over the rest of it."""
    content = text.encode()
    return content.replace(_BLANK.encode(), digest(content).encode(), 1)


def read_json(path: Path, remedy: str) -> dict[str, Any]:
    """Return the content and schema of a file that `sealed_json` encoded, after a check of its digest.

    Args:
        path: The file.
        remedy: Advice on how to restore the file, which ends the error message.

    Raises:
        DamagedError: if the file differs from what was written; names the file and the remedy.
        SchemaError: if the file has another schema.
    """
    try:
        if excess := RECORD.excess(path.stat().st_size):
            raise ExcessError(excess)
        content = path.read_bytes()
        if excess := RECORD_VALUES.excess(sum(map(content.count, (b",", b":", b"[", b"{")))):
            raise ExcessError(excess)
        record = json.loads(content)
    except OSError as error:
        raise DamagedError(f"cannot read {path}: {error.strerror}; {remedy}") from error
    except (ValueError, RecursionError) as error:
        raise DamagedError(f"cannot read {path}: it is damaged: {_short(error)}; {remedy}") from error
    schema = record.get("schema") if isinstance(record, dict) else None
    if type(schema) is not int:
        raise DamagedError(f"cannot read {path}: it is damaged: it names no schema; {remedy}")
    if not _is_whole(content) and (schema == SCHEMA or "digest" in record):
        raise DamagedError(f"cannot read {path}: it is damaged: its content has another digest than it says; {remedy}")
    if schema != SCHEMA:
        raise SchemaError(path, schema)
    del record["digest"]
    return dict(record)


def read_file(path: Path, files: Mapping[str, str], remedy: str) -> bytes:
    """Return the content of a file whose digest is in the record of the same folder.

    Args:
        path: The file.
        files: Digests by file name.
        remedy: Advice on how to restore the file, which ends the error message.

    Raises:
        DamagedError: if the file is missing, or differs from what was written.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise DamagedError(f"cannot read {path}: {error.strerror}; {remedy}") from error
    if files.get(path.name) != digest(content):
        raise DamagedError(f"cannot read {path}: it is damaged: its content has another digest than stored; {remedy}")
    return content


class Lines:
    """Chain of digests in a file that grows line by line.

    Each line begins with half of a SHA-256 over the digest of the previous line and the content of the line. The chain
    detects a line that was changed, removed or moved.
    """

    def __init__(self) -> None:
        self._last = ""

    def seal(self, text: str) -> str:
        """Return the next line, without a line break."""
        self._last = digest(f"{self._last}\n{text}".encode())[:_LINE_HEX]
        return f"{self._last} {text}"

    def read(self, content: bytes) -> Iterator[str]:
        """Yield the content of each line of a file; skip a last line that its writer has not completed.

        Raises:
            ValueError: at the first line that differs from what was written.
        """
        for number, line in enumerate(content.decode().split("\n")[:-1], start=1):
            own = line.partition(" ")[2]
            if self.seal(own) != line:
                raise ValueError(f"line {number} has another digest than it says")
            yield own


def _is_whole(content: bytes) -> bool:
    found = _DIGEST.search(content)
    if found is None:
        return False
    blank = content[: found.start(1)] + _BLANK.encode() + content[found.end(1) :]
    return digest(blank).encode() == found[1]


def _short(error: Exception) -> str:
    return " ".join(str(error).split())[:200]


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
