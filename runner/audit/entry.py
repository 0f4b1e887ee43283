"""One printed equation as data: where it stands, how it is printed, what it claims to equal.

Entries live in YAML files, one for each part of a source (`runner/works/<source>/equations/*.yaml`):

    source: xarm7                  # the work, by its folder
    symbols: xarm7.symbols         # function of equations/truths that draws the sample, by name of the symbol
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
        truth: xarm7.transform     # what it claims to equal: a Truth of equations/truths, worked out twice
        finding: ...               # what is wrong, in words

Elements are expressions of `expressions.py`. An equation that is no arithmetic, such as a relation between matrices,
stands as `math` (in Typst) with the name of the function that evaluates it (`code: xarm7.left_pseudo_inverse`). The
verdict is never stored: `verdict.py` works it out.
"""

from collections.abc import Iterator
from functools import lru_cache
from typing import Self

import yaml
from pydantic import Field, ValidationError, model_validator

from runner.audit.sources import folder
from runner.errors import RunnerError
from runner.registry import StrictModel


class Form(StrictModel):
    """One form of an equation: expressions, or mathematics with the function that evaluates it.

    Attributes:
        elements: Expression of each element, by name.
        math: The equation in Typst mathematics, where it is no arithmetic or where its layout matters.
        code: Function of equations/truths that returns its elements at the samples.
    """

    elements: dict[str, str] = Field(default_factory=dict)
    math: str = ""
    code: str = ""

    @model_validator(mode="after")
    def _evaluated_one_way(self) -> Self:
        if self.elements and self.code:
            raise ValueError("has elements and code; one of them evaluates it")
        if not (self.elements or self.math):
            raise ValueError("has neither elements nor math: nothing to show")
        return self


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
        unit: Unit of its error. Errors in "rad" are angles: they are taken the short way round.
        tolerance: Largest error, in its unit, that rounding may cause.
        finding: What is wrong and what it does, in words; Text of a report.
        rollout: Function of equations/rollouts that runs the wrong form beside the right one, or "".
    """

    id: str
    number: str
    place: str
    title: str
    printed: Form
    repair: Repair | None = None
    corrected: Form | None = None
    truth: str = ""
    unit: str = "1"
    tolerance: float = Field(default=1e-9, gt=0)
    finding: str = ""
    rollout: str = ""


class Part(StrictModel):
    """One data file.

    Attributes:
        source: The work.
        symbols: Function of equations/truths that draws the sample.
        entries: Its equations, in the order of the text.
    """

    source: str
    symbols: str
    entries: list[Entry]


@lru_cache(maxsize=8)
def parts(source: str) -> tuple[Part, ...]:
    """Return the data files of a source, in the order of their names.

    Raises:
        RunnerError: If a file does not fit the format; names the file and the keys.
    """
    found = sorted(folder(source).glob("*.yaml"))
    return tuple(_read(path.name, path.read_text(encoding="utf-8")) for path in found if path.name != "inventory.yaml")


def entries(source: str) -> Iterator[tuple[Part, Entry]]:
    """Yield each equation of a source with the file it belongs to."""
    for part in parts(source):
        for entry in part.entries:
            yield part, entry


def _read(name: str, text: str) -> Part:
    try:
        return Part.model_validate(yaml.safe_load(text))
    except ValidationError as error:
        lines = [f"{'.'.join(map(str, problem['loc']))}: {problem['msg']}" for problem in error.errors()]
        raise RunnerError(f"{name}: " + "; ".join(lines)) from error
