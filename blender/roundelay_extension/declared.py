# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties of the library's options: name, text, default, range and unit as it declares them."""

from __future__ import annotations

from types import NoneType
from typing import Any

from bpy.props import BoolProperty, FloatProperty, IntProperty

from roundelay.base.options import Declared, choices, leaves

# Digits after the point in a panel.
_DIGITS = 2
_PROPERTIES: dict[type, Any] = {bool: BoolProperty, int: IntProperty, float: FloatProperty}


def declared(options: type, name: str) -> Declared:
    """Return how the library declares an option."""
    (found,) = (one for one in leaves(options) if one.name == name)
    return found


def shared(options: type, name: str, *, zero: bool = False, **more: Any) -> Any:
    """Return the property of an option of the library.

    One that is automatic unless given is so at 0; if 0 is a value of its own (`zero`), a switch
    beside it must tell. `more` is what Blender wants besides, such as the digits shown.
    """
    one = declared(options, name)
    kinds = choices(one.kind)
    make = next(_PROPERTIES[kind] for kind in _PROPERTIES if kind in kinds)
    automatic = NoneType in kinds and not zero
    digits = more.get("precision", _DIGITS)
    limits = {} if bool in kinds else _limits(one, automatic, digits)
    default = {} if one.default is None else {"default": one.default}
    text = description(one) + ("; 0 for automatic" if automatic else "")
    return make(name=one.label, description=text, **default, **limits, **more)


def description(one: Declared) -> str:
    """Return what an option does, in Blender's manner: the unit behind, no full stop."""
    unit = f", in {one.known.unit}" if one.known.unit else ""
    return one.known.text.rstrip(".") + unit


def _limits(one: Declared, automatic: bool, digits: int) -> dict[str, Any]:
    """Return the range; where a bound is not a value itself, the next that a panel shows is."""
    limits: dict[str, Any] = {}
    known = one.known
    step = 1 if int in choices(one.kind) else 10.0**-digits
    if automatic:
        limits["min"] = 0
    elif known.least is not None or known.above is not None:
        limits["min"] = known.least if known.above is None else known.above + step
    if known.most is not None or known.below is not None:
        limits["max"] = known.most if known.below is None else known.below - step
    return limits
