"""Printed equations as data: their YAML format and validation.

Entries are in YAML files, one for each part of a source (`equations/*.yaml` in a study's folder):

    robot: macro                   # of conf/robot, or of the folder, or a URDF: what truths `model.*` are about
    tip: q2                        # its frame that is meant, where that is not the config's
    joints: [theta1, theta2]       # what the joint positions are called, where that is not q1, q2, ...
    symbols: {l1: 0.5, s12: sin(theta1 + theta2)}  # what else is named; s1 = sin(theta1), c1 and so on are known
    entries:
      - id: xarm7-A13
        number: "A_13"             # as the source numbers or names it
        place: Forward kinematics  # section or page; the inventory counts by it
        title: Third column of the transform, x
        unit: "1"
        printed:
          elements: {A_13: "s6*(c5*(c4*(s1*s3 - c1*c2*c3) ..."}
        repair:                    # only where the text is damaged: what was mended, and why it must have been so
          why: A bracket is lost at the end of the line.
          elements: {A_13: ...}
        corrected:                 # only where it is wrong as printed
          elements: {A_13: ...}
        truth: model.jacobian      # what it claims to equal, worked out twice; see `model_truths.py`
        tip: q3                    # frame of this one, where that is not the file's
        finding: ...               # what is wrong, in words

If a model is not enough, `truth: xarm7.transform` names a Truth in `equations/truths/xarm7.py` of the folder.
`symbols: xarm7.symbols` names a function of that module that draws the sample; `robot` is then omitted.

Elements are expressions in the syntax of `runner/base/expressions/parser.py`; the report shows these texts. Their names
can be vectors and matrices of the sample, as in `Lambda: transpose(inverse(J)) @ M @ inverse(J)`. They can also be
elements of other entries of the file, which then stand for their right form. `letters` sets names as the source does:

    letters: {Lambda: Lambda(x), dq: dot(q)}    # in Typst mathematics

If an equation has no such form, `math` contains it in Typst, and `code: xarm7.left_inverse` names the function that
evaluates it. The verdict is never stored: `verdict.py` computes it.
"""

from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Self

from pydantic import BeforeValidator, Field, model_validator

from runner.audit.sources import Source, Where, source_of
from runner.base.data_file import read_data
from runner.base.expressions.grammar import ExpressionError
from runner.base.expressions.parser import parse
from runner.base.sanitize import quoted
from runner.schema.model import StrictModel


def _as_text(value: object) -> str:
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        raise ValueError(f"is {quoted(value)}; allowed: an expression or a number")
    return str(value)


Written = Annotated[str, BeforeValidator(_as_text)]
"""An expression, or a number, which needs no quotes."""


class Form(StrictModel):
    """One form of an equation: expressions, or mathematics with the function that evaluates it.

    Attributes:
        elements: Expression of each element, by name.
        math: The equation in Typst mathematics, where it is no arithmetic or where its layout matters.
        code: Function of equations/truths that returns its elements at the samples.
    """

    elements: dict[str, Written] = Field(default_factory=dict)
    math: str = ""
    code: str = ""

    @model_validator(mode="after")
    def _evaluated_one_way(self) -> Self:
        if self.elements and self.code:
            raise ValueError("has elements and code; one of them evaluates it")
        if not (self.elements or self.math):
            raise ValueError("has neither elements nor math: nothing to show")
        return self

    @property
    def readable(self) -> bool:
        """Whether all its expressions can be parsed."""
        try:
            return all(map(parse, self.elements.values()))
        except ExpressionError:
            return False


class Repair(Form):
    """A form mended where the text, not the author, is at fault.

    Attributes:
        why: What was mended, and how we know.
    """

    why: str


class Entry(StrictModel):
    """One printed equation.

    Attributes:
        id: Its name in the audit.
        number: Its number or name in the source.
        place: Section or page.
        title: What it is, in a few words.
        printed: As it stands.
        repair: As it must have stood, where the text is damaged.
        corrected: The right form, where it is wrong as printed.
        truth: What it claims to equal; "" where it only names things, or is unreadable.
        tip: Frame that a truth of the model is about, where it is another than the file's.
        unit: Unit of its error. Errors in "rad" are angles: they are taken the short way round.
        tolerance: Largest error, in its unit, that rounding may cause.
        finding: What is wrong and what it does, in words; Text of a report.
        rollout: Function of equations/rollouts that runs the wrong form beside the right one, or "".
        letters: Names as the source writes them in this equation.
    """

    id: str
    number: str
    place: str
    title: str
    printed: Form
    repair: Repair | None = None
    corrected: Form | None = None
    truth: str = ""
    tip: str = ""
    unit: str = "1"
    tolerance: float = Field(default=1e-9, gt=0)
    finding: str = ""
    rollout: str = ""
    letters: dict[str, str] = Field(default_factory=dict)

    @property
    def right(self) -> Form:
        """The form that is meant to be right."""
        return self.corrected or self.repair or self.printed


class Content(StrictModel):
    """What a data file says.

    Attributes:
        robot: Name of the robot, or its URDF; "" where no truth is a model's.
        tip: Its frame that is meant; "" is the config's tip.
        joints: Names of its joint positions; none are q1 to qn.
        symbols: Function of equations/truths that draws the sample; or what is named beside the robot's motion.
        letters: Names as the source writes them, in Typst mathematics.
        entries: Its equations, in the order of the text.
    """

    robot: str = ""
    tip: str = ""
    joints: tuple[str, ...] = Field(default=(), strict=False)
    symbols: str | dict[str, Written] = Field(default_factory=dict)
    letters: dict[str, str] = Field(default_factory=dict)
    entries: list[Entry]

    @model_validator(mode="after")
    def _can_be_sampled(self) -> Self:
        if not (self.robot or isinstance(self.symbols, str)):
            raise ValueError("names no 'robot', so 'symbols' must name the function that draws the sample")
        return self


class Part(Content):
    """A data file of a source.

    Attributes:
        source: The study's folder.
        path: The file.
    """

    source: Source
    path: Path


def parts(where: Where) -> tuple[Part, ...]:
    """Return the data files of a source, in the order of their names.

    Raises:
        RunnerError: If there is no such source, or a file does not fit the format; names file, entry and key.
    """
    source = source_of(where)
    found = [path for path in sorted(source.equations.glob("*.yaml")) if path.name != "inventory.yaml"]
    return tuple(_read(source, path, path.stat().st_mtime_ns) for path in found)


def entries(where: Where) -> Iterator[tuple[Part, Entry]]:
    """Yield each equation of a source with the file it belongs to."""
    for part in parts(where):
        for entry in part.entries:
            yield part, entry


def right_elements(part: Part) -> dict[str, str]:
    """Return the elements of all entries of a file in their right form, by name."""
    forms = [entry.right for entry in part.entries if entry.right.readable]
    return {name: text for form in forms for name, text in form.elements.items()}


@lru_cache(maxsize=64)
def _read(source: Source, path: Path, _changed: int) -> Part:
    return Part(source=source, path=path, **dict(read_data(path, Content)))
