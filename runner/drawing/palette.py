"""Colours of curves and links, told apart by readers with any colour vision, for paper and for a dark screen."""

LIGHT = ("#1f5fa8", "#c8442f", "#1c8a63", "#b97a00", "#7a4fa6", "#0e8ca3", "#a03a6b", "#5b6570")
DARK = ("#6aaef2", "#ff8a73", "#53cfa0", "#efb945", "#bd9af0", "#57cfe3", "#ec8fbb", "#a9b4c0")

DESIRED = "#8a929c"
"""Colour of a desired path, which belongs to no body."""


def color(index: int) -> str:
    """Return the colour of a palette index on paper, as #rrggbb; indices beyond the palette start again."""
    return LIGHT[index % len(LIGHT)]


def rgb(index: int) -> tuple[int, int, int]:
    """Return the colour of a palette index as red, green and blue from 0 to 255."""
    return rgb_of(color(index))


def rgb_of(text: str) -> tuple[int, int, int]:
    """Return a colour written as #rrggbb as red, green and blue from 0 to 255."""
    return int(text[1:3], 16), int(text[3:5], 16), int(text[5:7], 16)


def indices(chosen: list[int | None]) -> list[int]:
    """Give every curve a palette index: its own where it has one, otherwise the next that no curve has chosen."""
    taken = {index for index in chosen if index is not None}
    free = (index for index in range(len(chosen) + len(taken)) if index not in taken)
    return [next(free) if index is None else index for index in chosen]
