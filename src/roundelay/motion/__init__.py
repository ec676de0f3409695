"""Motions of skeletons, and what the search sees of them."""

from roundelay.motion.motion import Motion

__all__ = ["Motion"]
