"""Text of a PDF, page by page, and the sizes of its letters."""

import math
from collections.abc import Iterator

from pypdfium2 import PdfDocument, raw


def pages(content: bytes) -> list[str]:
    """Return the text of each page of a PDF."""
    return [page.get_textpage().get_text_bounded() for page in PdfDocument(content)]


def letter_sizes(content: bytes) -> Iterator[tuple[str, float]]:
    """Yield each letter of a PDF with its size as printed, in pt: the font's, scaled by figure and page."""
    matrix = raw.FS_MATRIX()
    for page in PdfDocument(content):
        text = page.get_textpage()
        for place in range(text.count_chars()):
            if not raw.FPDFText_IsGenerated(text, place):
                raw.FPDFText_GetMatrix(text, place, matrix)
                scale = math.hypot(matrix.c, matrix.d)
                yield chr(raw.FPDFText_GetUnicode(text, place)), raw.FPDFText_GetFontSize(text, place) * scale
