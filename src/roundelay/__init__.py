"""From raw motion capture to clean behaviours and seamless, loopable, blendable cycles.

The public names stand in ``__init__.pyi``, one a line with its home. They are loaded when first
used, so that the command line answers at once.
"""

from importlib import import_module as _import_module


def _listed() -> dict[str, str]:
    """Return the home of every name in the stub."""
    with open(f"{__path__[0]}/__init__.pyi", encoding="utf-8") as stub:
        words = [line.split() for line in stub if line.startswith("from ")]
    return {name: home for _, home, _, name, *_ in words}


_HOMES = _listed()
__all__ = sorted(name for name in _HOMES if not name.startswith("_"))


def __getattr__(name: str) -> object:
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module 'roundelay' has no attribute {name!r}")
    if home == __name__:
        return _import_module(f"{home}.{name}")
    return getattr(_import_module(home), name)


def __dir__() -> list[str]:
    return sorted({*_HOMES, *(name for name in globals() if name.startswith("_"))})
