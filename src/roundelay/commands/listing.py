"""What is registered, put into the help of a command when it is asked for."""

from __future__ import annotations

from collections.abc import Callable

__all__ = ["filled"]


def filled(text: str) -> str:
    """Fill "{readers}" and the like in a help text with what is registered, plug-ins too."""
    for name, listed in _LISTS.items():
        if f"{{{name}}}" in text:
            text = text.replace(f"{{{name}}}", listed())
    return text


def _readers() -> str:
    from roundelay.formats import in_words, readers

    return in_words(readers)


def _writers() -> str:
    from roundelay.formats import in_words, writers

    return in_words(writers)


def _formats() -> str:
    from roundelay.formats import suffixes_of, writers

    return ", ".join(suffix[1:] for suffix in suffixes_of(writers))


def _methods() -> str:
    from roundelay.segmentation import method_names

    return ", ".join(method_names())


def _proposers() -> str:
    from roundelay.timeline.proposals import proposers

    return ", ".join(proposers.names())


def _profiles() -> str:
    from roundelay.loops.profiles import profiles

    return ", ".join(profiles.names())


_LISTS: dict[str, Callable[[], str]] = {
    "readers": _readers,
    "writers": _writers,
    "formats": _formats,
    "methods": _methods,
    "proposers": _proposers,
    "profiles": _profiles,
}
