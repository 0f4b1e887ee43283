"""Text of a PDF, page by page."""

from pypdfium2 import PdfDocument


def pages(content: bytes) -> list[str]:
    """Return the text of each page of a PDF."""
    return [page.get_textpage().get_text_bounded() for page in PdfDocument(content)]
