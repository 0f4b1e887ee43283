"""Documents for the tests of the renderers: every block type, with one string in every field."""

import numpy as np

from runner.papers.reporting.claims import Claim, ClaimResult, Verdicts
from runner.papers.reporting.equation import Equation, EquationForm, Equations
from runner.reporting.document import (
    Code,
    Curves,
    Document,
    Formula,
    Items,
    Map,
    Maps,
    Notice,
    Origin,
    Panel,
    Picture,
    Playback,
    PlaybackBody,
    Provenance,
    RunList,
    Section,
    Series,
    Table,
    Text,
)
from runner.reporting.markup import link_text, mark_text
from runner.reporting.table import Column, numbers

SVG = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 40 20" width="40" height="20"><path d="M0 0h40v20z"/></svg>'

HOSTILE = (
    "<script>alert(1)</script>",
    '#read("/etc/passwd")',
    '"]#',
    "back\\slash \\\\ \\n \\u{41}",
    "{{ 7*7 }} {% x %} << 7*7 >> <% x %>",
    "two\nlines\r\n\tand a tab",
    "Größe αβγ → 日本",
    'a <b>bold</b> <a href="https://evil.example/">link</a><br>&lt;',
    "$ lone dollar",
    "</script><!-- --> \u2028",
    '$#read("/etc/passwd")$ and $unknown_name$',
    "_underscore %{x} *star* @ref <label> = head `raw`",
    "\x00\x07\ud800",
)


def playback(count: int = 60, **changes: object) -> Playback:
    times = np.linspace(0.0, 2.0, count)
    angle = np.sin(times)
    zero = np.zeros(count)
    turned = np.stack([np.cos(angle / 2), zero, -np.sin(angle / 2), zero], axis=1)
    tip = np.stack([np.cos(angle), zero, np.sin(angle)], axis=1)
    body = PlaybackBody("link", [((0, 0, 0), (1, 0, 0), 0.05)], [((1, 0, 0), 0.07)], np.zeros((count, 3)), turned)
    return Playback(**({"caption": "It moves.", "times": times, "bodies": [body], "path": tip, "desired": tip + 0.01,
                        "still": SVG} | changes))  # fmt: skip


def curves(text: str = "error", **changes: object) -> Curves:
    x = np.linspace(0.0, 1.0, 50)
    series = [Series(text, x, x**2, low=x**2 - 0.1, high=x**2 + 0.1), Series("", x, x, "dashed"), Series(text, x, -x)]
    return Curves(**({"caption": text, "panels": [Panel(text, text, text, series)]} | changes))


def equations(text: str = "words", **changes: object) -> Equations:
    forms = [
        EquationForm(text, raw=[(False, text), (True, text)], note=text, whole=text),
        EquationForm(text, [['italic("J")_"11" = - italic("l") cos^2']]),
        EquationForm(text, [["J^+ = J^T (J J^T)^(-1)"]]),
        EquationForm(text, [[text]]),
    ]
    rows = [Equation(text, text, text, "wrong as printed", text, forms, text), Equation("n", "", "", "correct", "", ())]
    return Equations(**({"caption": text, "rows": rows} | changes))


def maps(text: str = "error", **changes: object) -> Maps:
    values = np.array([[1.0, 2.0, np.inf], [np.nan, 5.0, 6.0]])
    line = Series(text, np.array([0.0, 2.0]), np.array([1.0, 0.0]), "dashed")
    cells = Map(text, text, text, [text] * 3, [text] * 2, values, np.isnan(values), [line])
    pointed = Map(text, text, text, ["1", "2", "3"], ["1", "2"], values, values > 5, (), True, [text] * 6, ["ab"] * 6)
    return Maps(**({"caption": text, "value_label": text, "panels": [cells, pointed]} | changes))


def run_list(text: str = "words", **changes: object) -> RunList:
    given = {
        "caption": text,
        "axes": [(text, [text, "1"])],
        "levels": np.array([[0], [1]]),
        "metrics": [(text, "m"), ("peak", "1")],
        "values": np.array([[1.0, np.nan], [2e-5, 3.0]]),
        "hashes": ["ab" * 12, "cd" * 12],
        "failures": ["", text],
        "commands": [text, text],
        "folders": ["", "../../runs/x/"],
    }
    return RunList(**(given | changes))


def document(text: str = "words") -> Document:
    origin = Origin(text, text, text)
    blocks = [
        Text(text),
        Items(
            (
                f"of {mark_text('emphasis', 'emphasis')} and $tau_1$",
                f"{mark_text('code <b>', 'code')}; {link_text('page', 'https://example.org/a')}",
            )
        ),
        Code(text),
        Notice("warning", text, text),
        Formula(text, text),
        curves(text, origin=origin),
        maps(text, origin=origin),
        run_list(text, origin=origin),
        Picture(text, SVG, text, origin=origin),
        Table(text, [text, *numbers(text)], [[text, text]] * 2, origin),
        Table(text, [text, Column(text, "code")], [[text, text]], origin, prose=True),
        Verdicts(
            text,
            [
                Claim(
                    text,
                    text,
                    text,
                    text,
                    [ClaimResult(text, text, "matches", text), ClaimResult(text, text, "differs", text, {text: text})],
                    text,
                    text,
                )
            ],
            origin,
        ),
        equations(text, origin=origin),
        playback(caption=text, origin=origin),
        Provenance([(text, text)]),
    ]
    return Document(text, text, text, [Section(text, blocks, [Section(text, [Text(text)])])], "2026-11-21")
