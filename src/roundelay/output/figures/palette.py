"""The colours that figures and page share."""

from __future__ import annotations

import numpy as np

__all__ = ["ACCENT", "COMPANION", "INK", "MUTED", "PALE", "phase_colours"]

INK, ACCENT, MUTED, PALE = "#33415c", "#d1495b", "#69727d", "#b8c0cc"
# Beside the accent, for what belongs to it.
COMPANION = "#e6a0aa"

# Oklab to linear sRGB (Ottosson 2020).
_TO_LMS = np.array(
    [[1.0, 0.3963377774, 0.2158037573],
     [1.0, -0.1055613458, -0.0638541728],
     [1.0, -0.0894841775, -1.2914855480]]
)  # fmt: skip
_TO_RGB = np.array(
    [[4.0767416621, -3.3077115913, 0.2309699292],
     [-1.2684380046, 2.6097574011, -0.3413193965],
     [-0.0041960863, -0.7034186147, 1.7076147010]]
)  # fmt: skip


def phase_colours(count: int, *, lightness: float = 0.68, chroma: float = 0.125) -> list[str]:
    """Return colours for a phase: a circle of hues of one lightness and strength.

    Parameters
    ----------
    count : int
        How many, at phases 0, 1 / count, and so on.
    lightness, chroma : float
        In Oklab.

    Returns
    -------
    list of str
        As ``#rrggbb``.
    """
    hue = 2 * np.pi * (np.arange(count) / count + 0.07)
    lab = np.stack([np.full(count, lightness), chroma * np.cos(hue), chroma * np.sin(hue)], axis=1)
    linear = np.clip((lab @ _TO_LMS.T) ** 3 @ _TO_RGB.T, 0.0, 1.0)
    curved = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return [f"#{r:02x}{g:02x}{b:02x}" for r, g, b in np.round(255 * curved).astype(int)]
