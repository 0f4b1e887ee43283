"""Colour palettes of curves and links for paper and dark screens, safe for colour-blind readers.

Any two colours of a palette differ by 20 or more in CIELAB; a test measures it. The same is true for protanopia and
deuteranopia (simulated after Machado, Oliveira and Fernandes, 2009).
"""

LIGHT = ("#0d4d8f", "#bb3a29", "#218e68", "#bb7c00", "#8a6bd4", "#1897b3", "#7b063b", "#4e6270")
DARK = ("#0e7ad2", "#f7816b", "#73dda2", "#efb945", "#9facff", "#75b9d3", "#ca6b90", "#b9e4e0")

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
