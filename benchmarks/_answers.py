"""What the product says of a take: behaviours with their frames, period, joints, probability."""

from __future__ import annotations

from dataclasses import dataclass

import roundelay as rl


@dataclass(frozen=True)
class Found:
    """A behaviour as far as it is measured; its period is in seconds."""

    kind: str
    spans: tuple[tuple[int, int], ...]
    period: float
    repetitions: float
    joints: tuple[str, ...]
    probability: float | None

    @property
    def frames(self) -> int:
        return sum(stop - start for start, stop in self.spans)

    def within(self, start: int, stop: int) -> int:
        """How many of some frames it covers."""
        return sum(max(0, min(stop, b) - max(start, a)) for a, b in self.spans)


def answers(motion: rl.Motion) -> list[Found]:
    """Return what is cyclic or closed by default options; nothing where a take is refused."""
    try:
        behaviours = rl.understand(motion).behaviours
    except rl.RoundelayError:
        return []
    return [
        Found(
            each.kind,
            tuple(each.spans),
            each.period,
            each.repetitions,
            each.joints,
            each.probability,
        )
        for each in behaviours
        if each.kind in ("cyclic", "closed")
    ]
