"""Safe YAML reader: limits on size, nesting, aliases, keys and tags.

A few lines of YAML can expand to more values than fit in memory (aliases of aliases). They can also describe endless
data (an anchor that contains itself), or nesting too deep for any loader. All checks run before any object is built.
"""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml
from yaml.resolver import Resolver

from runner.base.dotted_keys import calls_function
from runner.base.errors import RunnerError
from runner.base.limits import Limit
from runner.base.sanitize import quoted


@dataclass(frozen=True)
class Bounds:
    """Limits of a YAML document.

    Attributes:
        size: Largest size.
        values: Largest number of values, keys and collections, with each alias expanded.
        depth: Largest number of nested collections.
    """

    size: Limit
    values: int
    depth: int = 30

    @property
    def too_deep(self) -> str:
        """Return the message about a document that exceeds the depth."""
        return f"nested deeper than {self.depth} levels; no config needs more"


CONFIG = Bounds(Limit(250_000, "bytes"), values=10_000)
"""Limits of a config file, enough for about 3,000 way-points, which take Hydra one second."""
STORED = Bounds(Limit(2_000_000, "bytes"), values=100_000)
"""Limits of files that the runner wrote and of data files, such as a baseline or a set of inertials."""


class YamlError(RunnerError):
    """YAML that cannot be read, is too large, or refers to itself; the message contains the line."""


def read_yaml(text: str, name: str | Path, bounds: Bounds = STORED) -> Any:
    """Return the content of a YAML document as plain data.

    Args:
        text: The document.
        name: File of the document, for messages.
        bounds: Limits of the document.

    Raises:
        YamlError: if the document cannot be read or exceeds a limit; see check_yaml.
    """
    check_yaml(text, name, bounds, once=True)
    try:
        return yaml.load(text, yaml.CSafeLoader)
    except yaml.YAMLError as error:
        raise YamlError(explain_yaml(error, name)) from None
    except (ValueError, OverflowError) as error:  # invalid dates, numbers with more than 4,300 digits
        raise YamlError(f"{name}: {error}") from None


def check_yaml(text: str, name: str | Path, bounds: Bounds = CONFIG, once: bool = False) -> None:
    """Check a YAML document without building any object.

    Args:
        text: The document.
        name: File of the document, for messages.
        bounds: Limits of the document.
        once: True to reject duplicate keys, which PyYAML accepts and OmegaConf rejects.

    Raises:
        YamlError: if the document is not valid YAML or exceeds a limit, if an anchor contains itself, a key is not a
            string, a value has a tag, a number is not decimal, or a value has a ${...} that is not a reference to a
            key.
    """
    if excess := bounds.size.excess(len(text.encode(errors="replace"))):
        raise YamlError(f"{name}: {excess}")
    scan = _Scan(str(name), bounds, once)
    try:
        for event in yaml.parse(text, Loader=yaml.CSafeLoader):
            scan.take(event)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        if mark and "nesting depth" in str(error):  # newer LibYAML reads ahead, and stops at 1,000 levels
            raise YamlError(f"{name}, line {mark.line + 1}: {bounds.too_deep}") from None
        raise YamlError(explain_yaml(error, name)) from None


def explain_yaml(error: yaml.YAMLError, name: str | Path | None = None) -> str:
    """Return the file, line, column and problem of invalid YAML; `name` replaces the file name of the error."""
    mark = getattr(error, "problem_mark", None)
    where = name or (mark and mark.name) or "a YAML file"
    line = f", line {mark.line + 1}, column {mark.column + 1}" if mark else ""
    return f"{where}{line}: {getattr(error, 'problem', None) or error}"


def line_of(event: yaml.Event, name: str) -> str:
    """Return the file and the line of an event, for messages."""
    return name if event.start_mark is None else f"{name}, line {event.start_mark.line + 1}"


def line_with(text: str, path: Path) -> str:
    """Return the path of a YAML file, with the line that contains an override or its key, if there is one."""
    key = text.partition("=")[0]
    for event in yaml.parse(path.read_text(encoding="utf-8"), Loader=yaml.CSafeLoader):
        value = event.value.removeprefix("override ").lstrip("/") if isinstance(event, yaml.ScalarEvent) else ""
        if value and (value == text or f".{key}".endswith(f".{value}")):
            return line_of(event, str(path))
    return str(path)


# Plain scalars that YAML 1.1 reads in another base: 0b101 as 5, 0x10 as 16, 010 as 8, and 1:30 as 90, in base 60.
_OTHER_BASE = re.compile(r"[-+]?(0b[01_]+|0x[\da-fA-F_]+|0[0-7_]+|\d[\d_]*(:[0-5]?\d)+(\.[\d_]*)?)")

_DIGITS = 40  # more than any valid number has


def _not_decimal(text: str) -> Iterator[str]:
    """Yield a problem for a plain scalar that YAML reads as a number in another base."""
    number = yaml.load(text, yaml.CSafeLoader) if len(text) <= _DIGITS and _OTHER_BASE.fullmatch(text) else text
    if not isinstance(number, str):
        yield f"{text} is not a decimal number, and YAML reads it as {number}; write {number}, or put it in quotes"


@dataclass
class _Open:
    """Open collection: anchor, number of values so far, and whether a key comes next (None in a list)."""

    anchor: str | None
    values: int
    key_next: bool | None
    keys: set[str] = field(default_factory=set)


class _Scan:
    def __init__(self, name: str, bounds: Bounds, once: bool) -> None:
        self._name, self._bounds, self._once = name, bounds, once
        self._open = [_Open(None, 0, None)]
        self._sizes: dict[str, int] = {}
        self._resolver = Resolver()

    def take(self, event: yaml.Event) -> None:
        if isinstance(event, yaml.CollectionEndEvent):
            ended = self._open.pop()
            self._count(event, ended.anchor, ended.values)
        elif isinstance(event, yaml.NodeEvent):
            for problem in self._problems(event):
                raise YamlError(f"{line_of(event, self._name)}: {problem}")
            parent = self._open[-1]
            if parent.key_next and isinstance(event, yaml.ScalarEvent):
                if self._once and event.value in parent.keys:
                    raise YamlError(f"{line_of(event, self._name)}: the key {quoted(event.value)} stands twice")
                parent.keys.add(event.value)
            if parent.key_next is not None:
                parent.key_next = not parent.key_next
            if isinstance(event, yaml.CollectionStartEvent):
                keyed = True if isinstance(event, yaml.MappingStartEvent) else None
                self._open.append(_Open(event.anchor, 1, keyed))
            elif isinstance(event, yaml.AliasEvent):
                self._count(event, None, self._sizes[str(event.anchor)])
            else:
                self._count(event, event.anchor, 1)

    def _count(self, event: yaml.Event, anchor: str | None, values: int) -> None:
        if anchor is not None:
            self._sizes[anchor] = values
        self._open[-1].values += values
        if sum(each.values for each in self._open) > self._bounds.values:
            raise YamlError(
                f"{line_of(event, self._name)}: the file stands for more than {self._bounds.values} values, aliases "
                "counted as what they stand for; make it smaller"
            )

    def _problems(self, event: yaml.NodeEvent) -> Iterator[str]:
        if not isinstance(event, yaml.ScalarEvent | yaml.CollectionStartEvent):
            if any(event.anchor == each.anchor for each in self._open):
                yield f"*{event.anchor} stands inside of &{event.anchor}, and so for endless values; write it out"
            elif event.anchor not in self._sizes:
                yield f"*{event.anchor} stands for nothing: there is no &{event.anchor} before it"
            return
        if len(self._open) > self._bounds.depth and isinstance(event, yaml.CollectionStartEvent):
            yield self._bounds.too_deep
        if event.tag not in (None, "!"):
            yield f"the tag {quoted(event.tag)} says how to make a value; remove it: values are plain"
        if isinstance(event, yaml.ScalarEvent) and calls_function(event.value):
            yield f"{quoted(event.value)} calls a function; a file may only refer to keys, as in ${{robot.period}}"
        if isinstance(event, yaml.ScalarEvent) and event.implicit[0]:
            yield from _not_decimal(event.value)
        if self._open[-1].key_next and not self._is_text(event):
            found = quoted(event.value) if isinstance(event, yaml.ScalarEvent) else "a collection"
            yield f"the key {found} is not a string; put it in quotes, or look for a typing error"

    def _is_text(self, event: yaml.NodeEvent) -> bool:
        if not isinstance(event, yaml.ScalarEvent):
            return False
        resolve: Callable[..., str] = self._resolver.resolve
        return resolve(yaml.ScalarNode, event.value, event.implicit) in (
            "tag:yaml.org,2002:str",
            "tag:yaml.org,2002:merge",
        )
