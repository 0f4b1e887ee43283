"""Colour palettes of curves and links for paper and dark screens, safe for colour-blind readers.

Any two colours of a palette differ by 20 or more in CIELAB; a test measures it. The same is true for protanopia and
deuteranopia (simulated after Machado, Oliveira and Fernandes, 2009). The first four of LIGHT differ by 12 or more in
lightness, so that they are told apart in a grey print. A colour, a mark and a dash with one index are a look; a level
of an axis has one look in all figures of a report.
"""

LIGHT = ("#003775", "#a32318", "#1e845a", "#c78714", "#8a6bd4", "#1897b3", "#750037", "#4e6270")
DARK = ("#0e7ad2", "#f7816b", "#73dda2", "#efb945", "#9facff", "#75b9d3", "#ca6b90", "#b9e4e0")

MARKS = ("o", "s", "^", "D", "v", "P", "X", "<")
"""Mark of each look, as matplotlib names it."""

DASHES = ((), (5.0, 1.6), (7.0, 1.5, 1.2, 1.5), (1.2, 1.2), (9.0, 2.5), (5.0, 1.2, 1.2, 1.2, 1.2, 1.2), (2.6, 1.2),
          (8.0, 1.5, 3.0, 1.5))  # fmt: skip
"""Dash of each look: lengths of strokes and gaps in widths of the line; empty for a solid line."""

MEANINGS = {"stable": 2, "unstable": 3}
"""Palette index of a curve whose name says how it went: green and orange."""


def color(index: int) -> str:
    """Return the colour of a palette index on paper, as #rrggbb; indices beyond the palette start again."""
    return LIGHT[index % len(LIGHT)]


def rounds(index: int) -> int:
    """Return the number of full rounds through the palette before an index: points of each time have their own mark."""
    return index // len(LIGHT)


def indices(chosen: list[int | None]) -> list[int]:
    """Give every curve a palette index: its own where it has one, otherwise the next that no curve has chosen."""
    taken = {index for index in chosen if index is not None}
    free = (index for index in range(len(chosen) + len(taken)) if index not in taken)
    return [next(free) if index is None else index for index in chosen]
