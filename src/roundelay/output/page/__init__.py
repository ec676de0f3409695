"""One self-contained HTML page of a capture: its motion, the evidence, the loops.

::

    build_page(motion, loops)       one string, no outside request
        capture.py                  joint positions, sampled and placed on the floor
        findings.py                 bars, coordinates, plane, loop, quality of each motion
        packing.py                  numbers to 16 bits, all of it deflated
        bundle.py                   template, style and modules to one file
"""

from roundelay.output.page.build import build_page

__all__ = ["build_page"]
