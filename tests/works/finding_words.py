"""The words of findings as they stand in the source, for a lint on numbers that are typed in them."""

import ast
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

_MATHEMATICS = re.compile(r"\$[^$]*\$")
# Names that hold a digit: parts of the source, of the arm, and of what the works number.
_NAMED = re.compile(
    r"\b(?:[Ff]igures?|[Ss]ections?|[Tt]ables?|[Cc]laims?|[Cc]hapters?|[Ee]quations?|[Mm]ethods?|[Jj]oints?|[Ll]inks?|"
    r"[Ff]rames?|[Pp]oses?|Mini|xArm|Meca|rk)[ -]?\(?\d+(?:\.\d+)*(?:(?:, | and | or | to )\d+(?:\.\d+)*)*|^\d[a-c]?\. "
)


_BOX = re.compile(r"^::: finding (.*?)^:::$", re.MULTILINE | re.DOTALL)
_INSERTED = re.compile(r"\{\{.*?\}\}", re.DOTALL)
_NUMBER = re.compile(r"\d+(?:\.\d+)?(?: [a-zA-Z%]+)?")


def typed_numbers(path: Path, names: Iterable[str]) -> Iterator[str]:
    """Yield each number that is typed in a finding's title or text in a module, with its line and the words.

    Args:
        path: The module.
        names: Names of the work's runs; a number with its unit that stands in one is a level of an axis.
    """
    levels = set(re.split(r"[/,] ?", "/".join(names)))
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
                        for number in _typed(text, levels):
                            yield f"{path.name}:{line}: {number}: {text}"


def typed_in_chapter(path: Path, names: Iterable[str]) -> Iterator[str]:
    """Yield the same for the boxes of a chapter in Markdown."""
    levels = set(re.split(r"[/,] ?", "/".join(names)))
    for box in _BOX.findall(path.read_text(encoding="utf-8")):
        words = "\n".join(line for line in _INSERTED.sub("…", box).splitlines() if not line.startswith("holds:"))
        for number in _typed(words, levels):
            yield f"{path.name}: {number}: {words}"


def _typed(text: str, levels: set[str]) -> set[str]:
    return set(_NUMBER.findall(_NAMED.sub("", _MATHEMATICS.sub("", text)))) - levels


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
