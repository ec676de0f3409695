"""The version, by itself so that every stage may record it."""

__version__ = "0.1.0"
