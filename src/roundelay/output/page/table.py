"""The quality table: figures with their names and units, for people."""

from __future__ import annotations

from roundelay.loops.quality import Quality

__all__ = ["quality_rows"]


def quality_rows(figures: Quality) -> list[tuple[str, str, str, str]]:
    """Return rows of what, the loop's figure, the figure to hold it against, and its name."""
    return [
        (
            "Largest rotation at the seam",
            f"{figures.seam_rotation:.1f}°",
            f"{figures.step_rotation:.1f}°",
            "largest elsewhere in the loop",
        ),
        (
            "Change of velocity at the seam",
            f"{figures.seam_velocity:.3f} /s",
            f"{figures.capture_velocity:.3f} /s",
            "95 % of the capture, body sizes",
        ),
        (
            "Slide of standing feet",
            f"{figures.loop_skate:.3f}",
            f"{figures.capture_skate:.3f}",
            "the capture, body sizes a period",
        ),
        (
            "Mean jerk",
            f"{figures.loop_jerk:.0f} /s³",
            f"{figures.capture_jerk:.0f} /s³",
            "the capture, body sizes",
        ),
        (
            "Error against the capture",
            f"{figures.template_error:.2f} rad",
            "",
            "RMS over frames, all joints",
        ),
        (
            "Made from",
            f"{figures.repetitions:.2f} periods",
            f"{figures.frames} frames",
            "of the capture",
        ),
    ]
