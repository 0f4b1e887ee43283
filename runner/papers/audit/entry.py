"""Printed equations as data: their YAML format and validation.

Entries are in YAML files, one for each part of a source (`equations/*.yaml` in a study's folder):

    robot: macro                   # of conf/robot, or of the folder, or a URDF: what derivations `model.*` are about
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
        emendation:                    # only where the text is damaged: what was emended, and why it must have been so
          why: A bracket is lost at the end of the line.
          elements: {A_13: ...}
        corrected:                 # only where it is wrong as printed
          elements: {A_13: ...}
        derivation: model.jacobian # what it claims to equal, by two independent derivations; see `model_derivations.py`
        tip: q3                    # frame of this one, where that is not the file's
        finding: ...               # what is wrong, a sentence

If a model is not enough, `derivation: xarm7.transform` names the Derivations in `equations/derivations/xarm7.py` of the
folder. `symbols: xarm7.symbols` names a function of that module that draws the sample; `robot` is then omitted.

`elements` gives the right side of each equation by its left side, in the syntax of
`runner/papers/expressions/parser.py`; the report shows the same strings. Names can be vectors and matrices of the
sample, as in `Lambda: transpose(inverse(J)) @ M @ inverse(J)`. They can also be left sides of other equations of the
file, which then stand for their right form. A left side can be an expression, as in `tau - G: M @ ddq + V`; its names
have their true values. `letters` sets names as the source does, and `indices` gives the numbers of a letter in
brackets:

    printed: {elements: {"Z[i]": "R[i] @ z"}}
    indices: {i: [1, 2, 3]}
    letters: {"R[i]": "attach(R, tl: 0, br: i)", dq: dot(q)}    # in Typst mathematics

If the text of a source is machine-readable, `read: thesis_appendix.read_1` under `printed` names the function that
returns `elements` from it. An emendation can have `replace: {h_12: {1/40000*c1: 1/4000*c1}}` instead of elements.
`math` contains a definition in Typst. If no expression has the value of an equation, `math` shows it and
`code: xarm7.left_inverse` names the function that evaluates it. The verdict is never stored: `verdict.py` computes it.
"""

import re
from collections.abc import Iterator, Mapping
from functools import lru_cache
from itertools import product
from pathlib import Path
from typing import Annotated, Self

from pydantic import BeforeValidator, Field, model_validator

from runner.base.arrays import FloatArray
from runner.base.data_file import read_data
from runner.base.errors import RunnerError
from runner.base.sanitize import quoted
from runner.papers.audit.evaluation import Numbered, SampleValues
from runner.papers.audit.sources import Source, Where, derivation_of, source_of
from runner.papers.expressions.grammar import ExpressionError
from runner.papers.expressions.parser import parse
from runner.papers.expressions.tree import Name, Node, at_places
from runner.schema.model import StrictModel


def _as_text(value: object) -> str:
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        raise ValueError(f"is {quoted(value)}; allowed: an expression or a number")
    return str(value)


_LEFT = -1  # place of a left side, which is in no right side
_NAME = re.compile(r"[\w']+")
_PLACES = re.compile(r"\[(.*?)\]")

Written = Annotated[str, BeforeValidator(_as_text)]
"""An expression, or a number, which needs no quotes."""


def left_side(name: str) -> Node:
    """Return the left side of an equation: mostly a name.

    Raises:
        ExpressionError: If it cannot be parsed.
    """
    return Name(name, _LEFT) if _NAME.fullmatch(name) else parse(name).root


class Form(StrictModel):
    """One form of an equation: expressions, or mathematics with the function that evaluates it.

    Attributes:
        elements: Right side of each equation, by its left side.
        math: The equation in Typst mathematics, if it defines a name, or if no expression has its value.
        code: Function of equations/derivations that returns the values of `math` at the samples.
    """

    elements: dict[str, Written] = Field(default_factory=dict)
    math: str = ""
    code: str = ""

    @model_validator(mode="after")
    def _evaluated_one_way(self) -> Self:
        if self.elements and (self.math or self.code):
            raise ValueError(f"has elements and {'math' if self.math else 'code'}; what is shown is evaluated")
        for name in self.elements:
            try:
                left_side(name)
            except ExpressionError as error:
                raise ValueError(f"'{name}' is not the left side of an equation: {error}") from error
        if not any(value for name, value in self if name not in ("code", "why")):
            raise ValueError("has neither elements nor math: nothing to show")
        return self

    @property
    def readable(self) -> bool:
        """True if all its expressions can be parsed."""
        try:
            return all(map(parse, self.elements.values()))
        except ExpressionError:
            return False


class Printed(Form):
    """The form in the source.

    Attributes:
        read: Function of equations/derivations that returns the elements, read from the source's own text.
    """

    read: str = ""


class Emendation(Form):
    """A form emended where the text, not the author, is at fault.

    Attributes:
        why: What was emended, and how we know.
        replace: Parts of the printed elements, by element, each with its replacement; the rest is as printed.
    """

    why: str
    replace: dict[str, dict[str, str]] = Field(default_factory=dict)

    def applied(self, elements: Mapping[str, str]) -> dict[str, str]:
        """Return the printed elements with the parts replaced.

        Raises:
            RunnerError: If a part is not once in its element.
        """
        found = dict(elements)
        for name, parts in self.replace.items():
            for old, new in parts.items():
                if (count := found.get(name, "").count(old)) != 1:
                    raise RunnerError(
                        f"emendation: replace: '{old}' is {count} times in '{name}' as printed; allowed: 1"
                    )
                found[name] = found[name].replace(old, new)
        return found


class Entry(StrictModel):
    """One printed equation.

    Attributes:
        id: Its name in the audit.
        number: Its number or name in the source.
        place: Section or page.
        title: What it is, in a few words.
        printed: The form in the source.
        emendation: The emended form, if the text is damaged.
        corrected: The right form, if it is wrong as printed.
        derivation: Reference derivations of what it claims to equal; "" where it only names things, or is unreadable.
        tip: Frame that a derivation from the model is about, where it is another than the file's.
        unit: Unit of its error. Errors in "rad" are angles: they are taken the short way round.
        tolerance: Largest error, in its unit, that rounding may cause.
        finding: What is wrong, and its effect; Text of a report. `{largest}` and `{typical}` are the errors
            of the form as printed, `{size}` is the largest true value.
        consequence: Function of equations/consequences that simulates what the wrong form causes, or "".
        letters: Names as the source writes them in this equation.
        indices: Numbers that a letter in square brackets stands for; the equation holds for each of them.
    """

    id: str
    number: str
    place: str
    title: str
    printed: Printed
    emendation: Emendation | None = None
    corrected: Form | None = None
    derivation: str = ""
    tip: str = ""
    unit: str = "1"
    tolerance: float = Field(default=1e-9, gt=0)
    finding: str = ""
    consequence: str = ""
    letters: dict[str, str] = Field(default_factory=dict)
    indices: dict[str, list[int]] = Field(default_factory=dict)

    @property
    def true_form(self) -> Form:
        """The form that is meant to be right."""
        return self.corrected or self.emendation or self.printed

    def as_read(self, source: Source) -> "Entry":
        """Return the same with the elements that a function reads, and with the parts replaced that are emended."""
        printed, emendation = self.printed, self.emendation
        if printed.read:
            printed = printed.model_copy(update={"elements": derivation_of(source, printed.read)()})
        if emendation and emendation.replace:
            emendation = emendation.model_copy(update={"elements": emendation.applied(printed.elements)})
        return self.model_copy(update={"printed": printed, "emendation": emendation})

    def equations(self, form: Form) -> Iterator[tuple[str, Numbered]]:
        """Yield the left and right sides of a form's equations, for each number that a letter stands for."""
        for name, text in form.elements.items():
            places = "".join(_PLACES.findall(f"{name} {text}"))
            letters = [letter for letter in self.indices if letter in places]
            for numbers in product(*(self.indices[letter] for letter in letters)):
                yield name, Numbered(text, dict(zip(letters, numbers, strict=True)))


class Content(StrictModel):
    """Content of a data file.

    Attributes:
        robot: Name of the robot, or its URDF; "" where no derivation is a model's.
        tip: Its frame that is meant; "" is the config's tip.
        joints: Names of its joint positions; none are q1 to qn.
        symbols: Function of equations/derivations that draws the sample; or further names besides the robot's motion.
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


class SourceFile(Content):
    """A data file of a source.

    Attributes:
        source: The study's folder.
        path: The file.
    """

    source: Source
    path: Path


def parts(where: Where) -> tuple[SourceFile, ...]:
    """Return the data files of a source, in the order of their names.

    Raises:
        RunnerError: If there is no such source, or a file does not fit the format; names file, entry and key.
    """
    source = source_of(where)
    found = [path for path in sorted(source.equations.glob("*.yaml")) if path.name != "inventory.yaml"]
    return tuple(_read(source, path, path.stat().st_mtime_ns) for path in found)


def entries(where: Where) -> Iterator[tuple[SourceFile, Entry]]:
    """Yield each equation of a source with the file it belongs to."""
    for part in parts(where):
        for entry in part.entries:
            yield part, entry


def right_elements(part: SourceFile) -> dict[str, Numbered]:
    """Return the right sides of all equations of a file in their right form, by name."""
    found = [each for entry in part.entries if entry.true_form.readable for each in entry.equations(entry.true_form)]
    return {at_places(name, right.numbers): right for name, right in found}


def form_values(
    entry: Entry, form: Form, symbols: Mapping[str, FloatArray], others: Mapping[str, Numbered]
) -> SampleValues:
    """Return the values of a form's equations by name.

    Args:
        entry: The equation.
        form: One of its forms; a name that it defines counts before a symbol.
        symbols: Values of each symbol at the samples.
        others: The other equations of its file in their right form; see `right_elements`.
    """
    own = {at_places(name, right.numbers): right for name, right in entry.equations(form)}
    return SampleValues({name: values for name, values in symbols.items() if name not in own}, {**others, **own})


def values_at(where: Where, name: str, symbols: Mapping[str, FloatArray], *, corrected: bool = False) -> SampleValues:
    """Return the same for the equation of a source with this id, as printed or corrected."""
    part, entry = next((part, entry) for part, entry in entries(where) if entry.id == name)
    return form_values(entry, entry.true_form if corrected else entry.printed, symbols, right_elements(part))


@lru_cache(maxsize=64)
def _read(source: Source, path: Path, _changed: int) -> SourceFile:
    return SourceFile(source=source, path=path, **dict(read_data(path, Content)))
