"""Cells of a table that spreadsheets open: text stays text."""

from __future__ import annotations

__all__ = ["cell"]

# What a spreadsheet takes for the beginning of a formula.
_FORMULA = ("=", "+", "-", "@", "\t", "\r", "\n")


def cell(text: str) -> str:
    """Return a text for a cell of CSV; what a spreadsheet would compute gets an apostrophe."""
    return f"'{text}" if text.startswith(_FORMULA) else text
