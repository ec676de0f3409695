"""From raw motion capture to clean behaviours and seamless, loopable, blendable cycles."""

from roundelay.formats import read, write
from roundelay.motion import Motion, concatenate
from roundelay.skeleton import Skeleton

__version__ = "0.1.0"

__all__ = ["Motion", "Skeleton", "concatenate", "read", "write"]
