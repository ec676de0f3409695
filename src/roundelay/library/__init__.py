"""Libraries: thousands of clips cut, labelled, looped, grouped and searched.

::

    folders -> captures.py    which clips there are
            -> workers.py     many processes
            -> clips.py       one clip: segments, cycles, loops, signatures
            -> store.py       the log, the files
            -> groups.py      the same motion in all clips
            -> catalogue.py   search
"""

from roundelay.library.build import build_library
from roundelay.library.catalogue import Library, Match

__all__ = ["Library", "Match", "build_library"]
