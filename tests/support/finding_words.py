"""The words of findings unchanged in the source, for a lint on numbers that are typed in them."""

import ast
from collections.abc import Iterator, Set
from pathlib import Path

from runner.papers.study.check import typed_in


def typed_in_module(path: Path, levels: Set[str]) -> Iterator[str]:
    """Yield each number that is typed in a finding's title or text in a module, with its line and the words.

    Args:
        path: The module.
        levels: Levels of axes, which may be typed.
    """
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for function in (node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)):
        assigned = {
            target.id: node.value
            for node in ast.walk(function)
            if isinstance(node, ast.Assign)
            for target in node.targets
            if isinstance(target, ast.Name)
        }
        for call in (node for node in ast.walk(function) if isinstance(node, ast.Call)):
            if isinstance(call.func, ast.Name) and call.func.id == "finding":
                for words in call.args[:2]:
                    for line, text in _pieces(words, assigned):
                        for number in typed_in(text, levels):
                            yield f"{path.name}:{line}: {number}: {text}"


def _pieces(words: ast.expr, assigned: dict[str, ast.expr]) -> Iterator[tuple[int, str]]:
    inserted = [part for part in ast.walk(words) if isinstance(part, ast.Name) and part.id in assigned]
    for piece in (words, *(assigned[part.id] for part in inserted)):
        yield piece.lineno, _literal(piece)


def _literal(words: ast.expr) -> str:
    """Return the text of an expression with what is inserted left out."""
    if isinstance(words, ast.Constant):
        return words.value if isinstance(words.value, str) else ""
    if isinstance(words, ast.JoinedStr):
        return "".join(_literal(part) if isinstance(part, ast.Constant) else "…" for part in words.values)
    return ""
