"""All places of a module where an operator, a number, a call or a statement can be replaced by a wrong one."""

import ast
import re
import zlib
from collections import Counter
from collections.abc import Iterator

from tools.mutants.inside.blocks import mark
from tools.mutants.mutant import Mutant

_COMPARISONS = {
    ast.Lt: ("<", "<="),
    ast.LtE: ("<=", "<"),
    ast.Gt: (">", ">="),
    ast.GtE: (">=", ">"),
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
    ast.Is: ("is", "is not"),
    ast.IsNot: (r"is\s+not", "is"),
    ast.In: ("in", "not in"),
    ast.NotIn: (r"not\s+in", "in"),
}
_ARITHMETIC = {
    ast.Add: (r"\+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: (r"\*", "/"),
    ast.Div: ("/", "*"),
    ast.Pow: (r"\*\*", "*"),
    ast.FloorDiv: ("//", "/"),
}
_CALLS = {"sum": "max", "any": "all", "all": "any"}
for _one, _other in (("min", "max"), ("minimum", "maximum"), ("argmin", "argmax"), ("fmin", "fmax")):
    _CALLS |= {_one: _other, _other: _one}
_FOR_PEOPLE = {"print", "warn"}
_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)
_LEFT_OUT = (ast.Import, ast.ImportFrom, ast.Raise, ast.Assert, ast.JoinedStr)
Edit = tuple[int, int, str]  # range of bytes, and the text that replaces it


def places(path: str, source: str) -> list[Mutant]:
    """Return all mutants of a module; a few change nothing or do not parse (`Mutant.changes`)."""
    return list(_Places(path, source).all())


class _Places:
    def __init__(self, path: str, source: str) -> None:
        self._path, self._text = path, source.encode()
        self._lines = [0]
        for line in self._text.splitlines(keepends=True):
            self._lines.append(self._lines[-1] + len(line))
        self._ordinals: Counter[str] = Counter()
        self._tree = ast.parse(source)
        self._blocks = mark(self._tree)

    def all(self) -> Iterator[Mutant]:
        """Give the mutants of the module, in order."""
        for statement in self._tree.body:
            yield from self._under(statement, "", None, set())

    def _under(self, node: ast.AST, unit: str, name: str | None, known: set[str]) -> Iterator[Mutant]:
        """Give the mutants of a node and of all below it; `known` are the names that the function has assigned."""
        if isinstance(node, _LEFT_OUT) or _is_for_people(node) or _is_skipped(node):
            return
        index = getattr(node, "block", None)
        if isinstance(node, ast.stmt) and index is None:
            unit, name = self._source(node), _assigned(node) or name
        if isinstance(node, _FUNCTIONS):
            unit, known = self._source(node), {part.arg for part in ast.walk(node.args) if isinstance(part, ast.arg)}
        block = None if index is None else self._blocks[index]
        for start, end, new in self._edits(node, unit, known):
            owner, number = ("", None) if block is None else (block.owner, block.ordinal)
            ordinal = self._ordinals[unit]
            self._ordinals[unit] += 1
            at_import = name if block is None else None
            yield Mutant(self._path, start, end, new, unit, ordinal, owner, number, at_import)
        for field, value in ast.iter_fields(node):
            if field in ("annotation", "returns", "decorator_list", "type_params"):
                continue
            for child in value if isinstance(value, list) else [value]:
                if isinstance(child, ast.AST):
                    yield from self._under(child, unit, name, known)
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            known.add(node.id)

    def _edits(self, node: ast.AST, unit: str, known: set[str]) -> Iterator[Edit]:
        match node:
            case ast.Compare():
                sides = [node.left, *node.comparators]
                for left, operator, right in zip(sides, node.ops, sides[1:], strict=False):
                    yield from self._between(left, right, *_COMPARISONS[type(operator)])
            case ast.BinOp() if type(node.op) in _ARITHMETIC and not (_is_text(node.left) or _is_text(node.right)):
                yield from self._between(node.left, node.right, *_ARITHMETIC[type(node.op)])
            case ast.AugAssign():
                if type(node.op) in _ARITHMETIC:
                    old, new = _ARITHMETIC[type(node.op)]
                    yield from self._between(node.target, node.value, f"{old}=", f"{new}=")
                yield (*self._range(node), "pass")
            case ast.BoolOp():
                old, new = ("and", "or") if isinstance(node.op, ast.And) else ("or", "and")
                for left, right in zip(node.values, node.values[1:], strict=False):
                    yield from self._between(left, right, old, new)
            case ast.UnaryOp(op=ast.Not() | ast.USub()):
                old = "not" if isinstance(node.op, ast.Not) else "-"
                start = self._range(node)[0]
                yield start, start + len(old), ""
            case ast.Constant(value=bool()):
                yield (*self._range(node), str(not node.value))
            case ast.Constant(value=int() | float()):
                yield (*self._range(node), self._number(node, unit))
            case ast.Name(id=name) if name in _CALLS and isinstance(node.ctx, ast.Load):
                yield (*self._range(node), _CALLS[name])
            case ast.Attribute(attr=name) if name in _CALLS and isinstance(node.ctx, ast.Load):
                end = self._range(node)[1]
                yield end - len(name), end, _CALLS[name]
            case ast.Slice():
                for bound, shift in ((node.lower, "+ 1"), (node.upper, "- 1")):
                    if bound is not None and not isinstance(bound, ast.Constant):
                        start, end = self._range(bound)
                        yield start, end, f"({self._text[start:end].decode()}) {shift}"
            case ast.Expr(value=ast.Call()):
                yield (*self._range(node), "pass")
            case ast.Assign() if all(_stays_defined(target, known) for target in node.targets):
                yield (*self._range(node), "pass")

    def _number(self, node: ast.Constant, unit: str) -> str:
        """Return n + 1, 2 n or 0 by turns, so that numbers are drawn as often as operators."""
        number = node.value
        assert isinstance(number, int | float)
        turn = zlib.crc32(f"{self._ordinals[unit]} {unit}".encode()) % 3
        wrong = (number + 1, 2 * number, 0 * number)[turn]
        return repr(wrong if wrong != number else number + 1)

    def _between(self, left: ast.AST, right: ast.AST, old: str, new: str) -> Iterator[Edit]:
        """Give the replacement of the operator between two expressions."""
        begin, end = self._range(left)[1], self._range(right)[0]
        found = re.search(old.encode(), self._text[begin:end])
        if found:
            yield begin + found.start(), begin + found.end(), new

    def _range(self, node: ast.AST) -> tuple[int, int]:
        return self._lines[node.lineno - 1] + node.col_offset, self._lines[node.end_lineno - 1] + node.end_col_offset

    def _source(self, node: ast.AST) -> str:
        start, end = self._range(node)
        return self._text[start:end].decode()


def _is_for_people(node: ast.AST) -> bool:
    """Return True if a node is a call that shows a string, or the statement of one."""
    call = node.value if isinstance(node, ast.Expr) else node
    called = call.func if isinstance(call, ast.Call) else None
    return getattr(called, "id", getattr(called, "attr", None)) in _FOR_PEOPLE


def _is_skipped(node: ast.AST) -> bool:
    """Return True if a node is a block for type checkers, a list of public names, or the start of a script."""
    if isinstance(node, ast.If):
        return any(getattr(name, "id", "") in ("TYPE_CHECKING", "__name__") for name in ast.walk(node.test))
    return isinstance(node, ast.Assign) and _assigned(node) == "__all__"


def _assigned(node: ast.stmt) -> str | None:
    """Return the name that a statement assigns or defines."""
    target = node.targets[0] if isinstance(node, ast.Assign) else getattr(node, "target", node)
    name = getattr(target, "id", getattr(target, "name", None))
    return name if isinstance(name, str) else None


def _is_text(node: ast.expr) -> bool:
    return isinstance(node, ast.JoinedStr) or (isinstance(node, ast.Constant) and isinstance(node.value, str))


def _stays_defined(target: ast.expr, known: set[str]) -> bool:
    """Return True if what a statement assigns may be there without it; else leaving it out only gives a NameError."""
    if isinstance(target, ast.Tuple):
        return all(_stays_defined(part, known) for part in target.elts)
    return isinstance(target, ast.Attribute | ast.Subscript) or (isinstance(target, ast.Name) and target.id in known)
