"""What a result looks like in a line: arrays by their shape."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np

__all__ = ["brief"]


def brief(result: Any) -> str:
    """Return the representation of a dataclass; to be its ``__repr__``."""
    shown = ((one.name, getattr(result, one.name)) for one in fields(result) if one.repr)
    return f"{type(result).__name__}({', '.join(f'{name}={_short(x)}' for name, x in shown)})"


def _short(value: Any) -> str:
    return f"array{value.shape}" if isinstance(value, np.ndarray) else repr(value)
