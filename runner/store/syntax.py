"""Source content of a Python module, independent of its prose: listed fields of the syntax tree.

The content leaves out comments, formatting, docstrings, `pass`, `__all__`, code for type checkers, the arguments of
`raise` and the message of `assert`. It also leaves out imports, and replaces an imported name by the object that it
refers to. A field that a version of Python lacks is written as an empty field. All versions that read the source
therefore give the same content.
"""

import ast
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import groupby

_OURS = "runner"
_END = object()  # of a node or list

# Fields of each kind of node that are part of the content; `_fields` treats names, constants, f-strings and raise.
_TABLE = """
    Expr value; Return value; Delete targets; Assign targets value; AugAssign target op value;
    FunctionDef name type_params args returns decorator_list body; Await value; Yield value; YieldFrom value;
    AsyncFunctionDef name type_params args returns decorator_list body; Lambda args body;
    ClassDef name type_params bases keywords decorator_list body; AnnAssign target annotation value;
    TypeAlias name type_params value; TypeVar name bound default_value; ParamSpec name default_value;
    TypeVarTuple name default_value; For target iter body orelse; AsyncFor target iter body orelse;
    While test body orelse; If test body orelse; With items body; AsyncWith items body;
    withitem context_expr optional_vars; Match subject cases; match_case pattern guard body; MatchValue value;
    MatchSingleton value; MatchSequence patterns; MatchMapping keys patterns rest; MatchStar name;
    MatchClass cls patterns kwd_attrs kwd_patterns; MatchAs pattern name; MatchOr patterns; Assert test;
    Try body handlers orelse finalbody; TryStar body handlers orelse finalbody; ExceptHandler type name body;
    ImportFrom module level; Global names; Nonlocal names; BoolOp op values; NamedExpr target value;
    BinOp left op right; UnaryOp op operand; IfExp test body orelse; Dict keys values; Set elts;
    ListComp elt generators; SetComp elt generators; GeneratorExp elt generators; DictComp key value generators;
    comprehension target iter ifs is_async; Compare left ops comparators; Call func args keywords;
    FormattedValue value conversion format_spec; Attribute value attr; Subscript value slice; Starred value; List elts;
    Tuple elts; Slice lower upper step; keyword arg value; arg arg annotation;
    arguments posonlyargs args vararg kwonlyargs kw_defaults kwarg defaults
"""
_FIELDS = {kind: fields for kind, *fields in map(str.split, _TABLE.strip().split(";"))}


def content(tree: ast.Module, resolve: Callable[[str, str], str]) -> str:
    """Return the content of a module; an empty string if it only re-exports its imports.

    Args:
        tree: Syntax tree of the module.
        resolve: Function that returns the identifier of a name in a module of this package; "" is the module itself.
    """
    found: dict[str, set[str]] = {}
    for bound, module, name in imports(tree):
        ours = module.partition(".")[0] == _OURS
        found.setdefault(bound, set()).add(resolve(module, name) if ours else f"{module}:{name}")
    meanings = {bound: " ".join(sorted(names)) for bound, names in found.items()}
    out: list[str] = []
    left: list[object] = [statement for statement in reversed(tree.body) if _counts(statement)]
    while left:
        value = left.pop()
        if value is _END:
            out.append(")")
        elif isinstance(value, list) and (kept := [each for each in value if _counts(each)]):
            out.append("(")
            left += [_END, *reversed(kept)]
        elif value is None or isinstance(value, list):  # a field that some version of Python lacks may be either
            out.append("-")
        elif isinstance(value, ast.AST):
            out.append(f"({type(value).__name__} ")
            left += [_END, *reversed(_fields(value, meanings, resolve))]
        else:
            out.append(f"{value!a} ")
    return "".join(out)


def imports(tree: ast.Module) -> Iterator[tuple[str, str, str]]:
    """Yield each name that an import binds, its module, and its name in the module; "" for the module itself."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                top = alias.name.partition(".")[0]
                yield alias.asname or top, alias.name if alias.asname else top, ""
        elif isinstance(node, ast.ImportFrom):
            for alias in node.names:
                yield alias.asname or alias.name, "." * node.level + (node.module or ""), alias.name


def _counts(node: object) -> bool:
    """Return True if an element of a list is part of the content."""
    match node:
        case ast.Expr(ast.Constant(str())) | ast.Pass() | ast.Import() | ast.Assign([ast.Name("__all__")]):
            return False
        case ast.If(ast.Name("TYPE_CHECKING"), orelse=[]):
            return False
        case ast.ImportFrom(names=[ast.alias(name)]):
            return name == "*"
        case ast.ImportFrom():
            return False
    return True


def _fields(node: ast.AST, meanings: Mapping[str, str], resolve: Callable[[str, str], str]) -> list[object]:
    """Return the fields of a node that are part of the content: nodes, lists of nodes, strings, numbers or None."""
    match node:
        case ast.Name(name):
            return [meanings.get(name, name), name in meanings]
        case ast.Constant(str() as text):
            return [resolve(text, "") if text.startswith(f"{_OURS}.") else text]
        case ast.Constant(value):
            return [type(value).__name__, hex(value) if type(value) is int else repr(value)]
        case ast.JoinedStr(parts):
            return _joined(parts)
        case ast.Raise(ast.Call(error), cause) | ast.Raise(error, cause):
            return [error, cause]
    return [getattr(node, field, None) for field in _FIELDS.get(type(node).__name__, node._fields)]


def _joined(parts: Sequence[ast.expr]) -> list[object]:
    """Return the parts of an f-string with adjacent strings joined, because Python versions split them differently."""
    found: list[object] = []
    for text, some in groupby(parts, lambda part: isinstance(part, ast.Constant)):
        same = list(some)
        found += ["".join(str(part.value) for part in same if isinstance(part, ast.Constant))] if text else same
    return [part for part in found if part != ""]
