"""Random expressions, half of them hostile, and a guard that sees what code they run and what files they open."""

import functools
import os
import pathlib
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from random import Random
from typing import Any

from runner.base.errors import RunnerError
from runner.papers.expressions.evaluator import OperationBudget, Scope

_WATCHED = ("open", "exec", "compile", "import", "os.", "subprocess.", "socket.", "ctypes.", "shutil.", "marshal.")
_SYNTAX = "<unknown>"  # the file that Python names where a string is only made a syntax tree


@dataclass(frozen=True)
class Length:
    """A value with a listed field and a listed method, and one of each that is not listed."""

    metres: float
    secret: str = "not listed"

    def longer(self, by: float) -> "Length":
        return Length(self.metres + by)

    def open(self) -> None:
        raise AssertionError("a method that is not listed was called")

    def __add__(self, other: "Length") -> "Length":
        return Length(self.metres + other.metres) if isinstance(other, Length) else NotImplemented

    def __lt__(self, other: "Length") -> bool:
        return self.metres < other.metres if isinstance(other, Length) else NotImplemented

    def __neg__(self) -> "Length":
        return Length(-self.metres)


class Run:
    """An object that no expression may reach."""

    folder = pathlib.Path("run")


def total(values: list[float], start: float = 0.0) -> float:
    return sum(values, start)


def pair(first: Any, second: Any = None) -> list[Any]:
    return [first, second]


def apply(function: Callable[..., Any], *values: Any) -> Any:
    return function(*values)


def measure(of: float) -> Callable[[float], float]:
    return functools.partial(max, of)


FUNCTIONS: dict[str, Callable[..., Any]] = {
    "total": total,
    "pair": pair,
    "apply": apply,
    "measure": measure,
    "largest": max,
    "a_path": lambda: pathlib.Path("run"),
    "a_run": Run,
    "a_frame": lambda: sys._getframe(),
    "a_module": lambda: os,
    "a_nest": lambda: [1.0, {"run": Run()}],
    "an_array": lambda: memoryview(b"run"),
}
VALUES: dict[str, Any] = {
    "x": 2.5,
    "n": 7,
    "word": "wide",
    "flag": True,
    "nothing": None,
    "items": [1, 2.0, "three"],
    "many": list(range(9000)),
    "long": "w" * 9000,
    "table": {"a": 1, "b": {"c": 2.0}},
    "arm.mass": 3.25,
    "length": Length(1.5),
}
SCOPE = Scope(FUNCTIONS, VALUES, {Length: ("metres", "longer")})
_PLAIN = (bool, int, float, str, type(None), Length, functools.partial)
_REFUSAL = 3000  # characters

_ATTRIBUTES = (
    "__class__", "__globals__", "__builtins__", "__dict__", "__init__", "__code__", "__self__", "__func__", "__mro__",
    "__subclasses__()", "__reduce__()", "__call__", "func", "args", "secret", "open()", "folder", "format", "join",
    "real", "f_back", "gi_frame", "tb_frame", "keys()", "append(1)", "__class__.__base__.__subclasses__()",
    "__init__.__globals__['__builtins__']", "to_csv('f')", "read_text()", "metres.__class__", "longer.__self__",
)  # fmt: skip
_ATTACKS = (
    "__import__('os').system('touch pwned')", "__builtins__", "__builtins__['eval']('1')", "open('/etc/passwd').read()",
    "eval('1')", "exec('import os')", "compile('1', 'f', 'eval')", "globals()", "locals()", "vars()", "dir()",
    "getattr(x, 'real')", "breakpoint()", "input()", "help()", "exit()", "().__class__.__bases__[0].__subclasses__()",
    "(lambda: x)()", "[x for x in items]", "{x for x in items}", "{x: x for x in items}", "(x for x in items)",
    "f'{x}'", "f'{x.__class__}'", "f'{x!r:>99999}'", "'{0.__class__}'.format(x)", "'{}'.format_map(table)",
    "(y := 1)", "await x", "(yield)", "(yield from items)", "*items", "*items, *items", "{**table}", "{*items}",
    "pair(**table)", "pair(*items)", "apply(*many)", "items[::2]", "items[0:1]", "items[x]", "items[many]",
    "`x`", "x if", "print >> x", "x; x", "x = 1", "import os", "a\\nb", "\x00", "\ud800", "x # y", "x \\", "'", '"""',
    "\uff4f\uff53", "\u212f", "x\u202e", "𝐱", "__debug__", "...", "Ellipsis", "NotImplemented", "b'x'", "2j", "x @ x",
    "x // 0", "x % 0", "n << 99999999", "n >> 1", "n & 1", "n | 1", "n ^ 1", "~n", "not x", "x is x", "x in items",
    "a_path()", "a_run()", "a_frame()", "a_module()", "a_nest()", "an_array()", "a_nest()[1]['run']", "pair(a_run())",
    "apply(a_path)", "apply(a_module)", "apply(apply, apply, a_run)", "pair(pair, a_frame)", "measure(n).func",
    "length.secret", "length.open()", "length.longer", "length.longer(length)", "length.metres.real", "-word", "-items",
    "length + 1", "length < 1", "length * length", "-length", "length ** 2", "n ** length", "length ** n", "type(x)",
    "max(items)", "items.append(1)", "table.update(x)", "table['__class__']", "table[items]", "table.a", "{items: 1}",
    "{table: 1}", "pair(pair=1)", "pair(first=1, first=2)", "total('ab')", "total(many, many)", "total(1, 2, 3, 4)",
    "'%s' % pair", "'%s' % (items,)", "'%d' % word", "'%*d' % (999999999, 1)", "'%999999999d' % 1", "'%(a)s' % table",
    "'%s%s' % word", "'%c' % 9999999", "'%.999999999f' % x", "'%r' % x", "'%a' % x", "'%' % ()", "'%99.99f' % 1e308",
    "'%s' * 99999999", "word * 99999999", "items * 99999999", "many + many", "long + long", "[many, many]",
    "9**9**9", "9.0**9**9", "(-8)**(1/3)", "2**63", "2**62*2", "0**-1", "0.0**-1", "-0.0", "1e308*10", "1e999",
    "1/0", "1e999-1e999", "n**n**n**n", "1.5**99999", "x**-99999", "9" * 400, "9" * 5000, "0x" + "f" * 5000, "1_0",
    "0777", "1__0", "1e", "'" + "w" * 9990 + "'", "'a' 'b'", "'\\N{DIGIT ONE}'", "'\\x'", "r'\\'", "u'x'",
)  # fmt: skip
_SIGNS = ("+", "-", "*", "/", "**", "%", "//", "@", "<", "<=", ">", ">=", "==", "!=", "is", "is not", "in", "not in",
          "and", "or", "&", "|", "^", "<<", ">>", ",", ":=", ".", " ", "if x else")  # fmt: skip
_NESTS = (
    ("(", ")"), ("[", "]"), ("-", ""), ("not ", ""), ("pair(", ")"), ("{'a': ", "}"), ("items[", "]"), ("[*", "]"),
    ("(1+", ")"), ("(", "+1)"), ("2**", ""), ("1 if flag else ", ""), ("(lambda: ", ")"), ("~", ""), ("{", "}"),
    ("f'{", "}'"), ("[x for x in ", "]"), ("", ".real"), ("", "[0]"), ("", "()"), ("1<", ""), ("flag and ", ""),
)  # fmt: skip


def expression(seed: int, number: int) -> str:
    """Return an expression, hostile where its number is odd; the same for the same seed and number."""
    draw = Random(f"{seed} {number}")
    return _hostile(draw) if number % 2 else _sound(draw, draw.randrange(5))


def _sound(draw: Random, depth: int) -> str:
    """Return an expression that a chapter could contain; the kinds of its values need not fit."""

    def inner() -> str:
        return _sound(draw, depth - 1)

    if depth <= 0:
        return draw.choice(
            (*VALUES, "1", "-2", "0", "3.5", "1e-3", "'text'", "'%.2f'", "True", "None", "[]", "()", "{}")
        )
    listed = ", ".join(inner() for _ in range(draw.randrange(4)))
    made: tuple[Callable[[], str], ...] = (
        lambda: f"{inner()} {draw.choice(_SIGNS[:6])} {inner()}",
        lambda: f"({inner()} {draw.choice(_SIGNS[:5])} {inner()})",
        lambda: f"{inner()} {draw.choice(_SIGNS[8:20])} {inner()}",
        lambda: f"[{listed}]",
        lambda: f"({listed})",
        lambda: f"{{'a': {inner()}, 2: {inner()}}}",
        lambda: f"{draw.choice([*FUNCTIONS])}({listed})",
        lambda: f"apply({draw.choice([*FUNCTIONS])}, {inner()})",
        lambda: f"pair({inner()}, second={inner()})",
        lambda: f"total([*{inner()}, {inner()}])",
        lambda: f"{inner()}[{draw.choice(('0', '-1', chr(39) + 'a' + chr(39), 'n', inner()))}]",
        lambda: f"length.longer({inner()}).metres",
        lambda: f"{inner()} if {inner()} else {inner()}",
        lambda: f"'{draw.choice(('%s', '%d', '%.3f', '%+5.1e', '%g%%', '%s and %s'))}' % ({listed})",
        lambda: f"-{inner()}",
        lambda: f"not {inner()}",
    )
    return draw.choice(made)()


def _hostile(draw: Random) -> str:
    attack = draw.choice(_ATTACKS)
    kind = draw.randrange(8)
    if kind == 0:
        begin, end = draw.choice(_NESTS)
        times = draw.choice((2, 30, 59, 60, 61, 100, 199, 201, 1000, 3000))
        return begin * times + draw.choice(("1", "x", "items", attack)) + end * times
    if kind == 1:
        mixed = [draw.choice(_NESTS) for _ in range(draw.choice((3, 20, 70)))]
        return "".join(begin for begin, _ in mixed) + attack + "".join(end for _, end in reversed(mixed))
    if kind == 2:
        sign, part = (
            draw.choice(_SIGNS),
            draw.choice(("1", "x", "items", "many", "long", "word", "length", "[]", "''", attack)),
        )
        return f" {sign} ".join([part] * draw.choice((2, 10, 100, 1000, 1001, 2500)))
    if kind == 3:
        part = draw.choice(("many", "items", "[[]]", "{'a': many}", "long", "1", "*many", "pair(many)", attack))
        return f"{draw.choice(('[', 'pair(', 'apply(', '('))}{', '.join([part] * draw.choice((1, 2, 3, 100, 1100)))}]"[
            :-1
        ] + draw.choice("])")
    if kind == 4:
        owner = draw.choice((*VALUES, *FUNCTIONS, "''", "1", "()", "measure(1)", "length.longer", "a_run()", attack))
        return f"{owner}.{draw.choice(_ATTRIBUTES)}" + draw.choice(("", "()", "[0]", f".{draw.choice(_ATTRIBUTES)}"))
    if kind == 5:
        text = _sound(draw, 3)
        place = draw.randrange(len(text) + 1)
        return text[:place] + attack + text[place + draw.randrange(4) :]
    if kind == 6:
        letters = "()[]{}'\"\\.,:;*+-/%<>=!@~^&|# \n\t0123456789exn_" + "ä\u02b9\u0000\ud83d…"
        return "".join(draw.choice(letters) for _ in range(draw.choice((3, 20, 200))))
    return attack


@dataclass(frozen=True)
class Ended:
    """Outcome of an expression.

    Attributes:
        refused: True if the expression was refused; else it has a value.
        faults: Errors of this outcome.
    """

    refused: bool
    faults: tuple[str, ...] = ()


def attempt(text: str) -> Ended:
    """Evaluate an expression as one of a file, and judge how that ended."""
    faults: list[str] = []
    try:
        with _watched(faults):
            value = SCOPE.evaluate(text, OperationBudget())
    except RunnerError as error:
        if len(str(error)) > _REFUSAL:
            faults.append(f"a message of {len(str(error))} characters")
        return Ended(True, tuple(faults))
    except BaseException as error:  # whatever it is, no file may raise it
        return Ended(True, (*faults, f"raises {type(error).__name__}: {error}"[:200]))
    return Ended(False, (*faults, *_strange(value)))


def _strange(value: Any) -> Iterator[str]:
    """Yield what in a value is neither plain nor listed, nor a function that was given or that one returned."""
    left = [value]
    while left:
        each = left.pop()
        if type(each) in (list, tuple, dict):
            left += each.values() if isinstance(each, dict) else each
        elif type(each) not in _PLAIN and each not in (*FUNCTIONS.values(), VALUES["length"].longer):
            yield f"a value of {type(each)}"


_seen: list[str] | None = None


def _hook(event: str, arguments: tuple[Any, ...]) -> None:
    if _seen is not None and event.startswith(_WATCHED) and not (event == "compile" and arguments[1] == _SYNTAX):
        _seen.append(f"{event} {arguments!r:.100}")


@functools.cache
def _add_hook() -> None:
    """Add a hook that reports every action of Python; a hook cannot be removed again."""
    for text in ("totl", "\ud800"):
        with suppress(RunnerError):
            SCOPE.evaluate(text, OperationBudget())  # imports what only messages need
    sys.addaudithook(_hook)


@contextmanager
def _watched(seen: list[str]) -> Iterator[None]:
    """Note the code that is run and the files that are opened."""
    global _seen
    _add_hook()
    _seen = seen
    try:
        yield
    finally:
        _seen = None
