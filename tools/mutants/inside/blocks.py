"""Blocks of statements that run one after the other: where each begins, and which one a node of a tree is in.

A block begins where the body of a function, branch or loop begins, behind a statement that has such bodies, and at the
expression of a lambda. Statements that run when a module is imported have no block.
"""

import ast
from collections import Counter
from typing import NamedTuple

_WITH_DOCSTRING = (ast.FunctionDef, ast.AsyncFunctionDef)


class Block(NamedTuple):
    """A block of a module.

    Attributes:
        owner: Dotted name of the function, or "<lambda>" for one at import.
        ordinal: Number among the owner's blocks.
        body: The statements in which it begins, or the lambda.
        at: Index in `body`.
    """

    owner: str
    ordinal: int
    body: list[ast.stmt] | ast.Lambda
    at: int


def mark(tree: ast.Module) -> list[Block]:
    """Return the blocks of a module; each node gets the index of its block as `block` (None at import), and `owner`."""
    marking = _Marking()
    marking.visit(tree, None, "")
    return marking.blocks


def instrument(tree: ast.Module, first: int) -> None:
    """Let each block of a module set the byte `first` + its index of `block_probes.hits` when it begins."""
    blocks = mark(tree)
    for index, block in reversed(list(enumerate(blocks, first))):
        if isinstance(block.body, ast.Lambda):
            here = block.body.body
            block.body.body = ast.copy_location(ast.BoolOp(ast.Or(), [_expression(f"__hit__({index})"), here]), here)
        else:
            near = block.body[min(block.at, len(block.body) - 1)]
            probe = ast.parse(f"__hits__[{index}] = 1").body[0]
            block.body.insert(block.at, _moved(probe, near))
    if blocks:
        start = len(_heading(tree.body))
        probe = ast.parse("from block_probes import hit as __hit__, hits as __hits__").body[0]
        tree.body.insert(start, probe)
    ast.fix_missing_locations(tree)


class _Marking:
    def __init__(self) -> None:
        self.blocks: list[Block] = []
        self._ordinals: Counter[str] = Counter()

    def _begin(self, owner: str, body: list[ast.stmt] | ast.Lambda, at: int) -> int:
        self.blocks.append(Block(owner, self._ordinals[owner], body, at))
        self._ordinals[owner] += 1
        return len(self.blocks) - 1

    def visit(self, node: ast.AST, block: int | None, owner: str) -> None:
        """Mark a node and all below it."""
        node.block, node.owner = block, owner
        inner = f"{owner}.{node.name}".lstrip(".") if isinstance(node, (*_WITH_DOCSTRING, ast.ClassDef)) else owner
        for _, value in ast.iter_fields(node):
            if isinstance(value, list) and value and isinstance(value[0], ast.stmt):
                self._visit_body(node, value, block, inner)
            elif isinstance(node, ast.Lambda) and value is node.body:
                name = owner if block is not None else "<lambda>"
                self.visit(value, self._begin(name, node, 0), name)
            else:
                for child in value if isinstance(value, list) else [value]:
                    if isinstance(child, ast.AST):
                        self.visit(child, block, owner)

    def _visit_body(self, node: ast.AST, body: list[ast.stmt], block: int | None, owner: str) -> None:
        function = isinstance(node, _WITH_DOCSTRING)
        runs = function or (block is not None and not isinstance(node, ast.ClassDef))
        start = len(_heading(body)) if function else 0
        for at, statement in enumerate(body):
            if runs and (at == start or (at > start and _has_bodies(body[at - 1]))):
                block = self._begin(owner, body, at)
            self.visit(statement, block, owner)
        if runs and start == len(body):
            self._begin(owner, body, start)


def _heading(body: list[ast.stmt]) -> list[ast.stmt]:
    """Return the docstring and the imports from the future, which have to be first."""
    docstring = body[:1] if body and isinstance(body[0], ast.Expr) and isinstance(body[0].value, ast.Constant) else []
    future = [node for node in body if isinstance(node, ast.ImportFrom) and node.module == "__future__"]
    return [*docstring, *future]


def _has_bodies(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.If | ast.For | ast.While | ast.With | ast.Try | ast.Match | ast.AsyncFor)


def _expression(text: str) -> ast.expr:
    return ast.parse(text, mode="eval").body


def _moved(probe: ast.stmt, near: ast.stmt) -> ast.stmt:
    for node in ast.walk(probe):
        ast.copy_location(node, near)
    return probe
