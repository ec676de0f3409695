"""What the product says of a take: behaviours with their frames, period, joints, probability."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import roundelay as rl
from benchmarks._yardstick import body


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
        understand = getattr(rl, "understand", None)
        if understand is None:
            return list(_answers_of_evidence(motion))
        behaviours = understand(motion).behaviours
    except rl.RoundelayError:
        return []
    return [
        Found(
            each.kind,
            tuple((int(start), int(stop)) for start, stop in each.spans),
            float(each.period),
            float(each.repetitions),
            tuple(each.joints),
            None if each.probability is None else float(each.probability),
        )
        for each in behaviours
        if each.kind in ("cyclic", "closed")
    ]


def _answers_of_evidence(motion: rl.Motion) -> Iterator[Found]:
    """Adapt `find_periodic`: to be deleted with it."""
    seen = body(motion[:1])
    arms = {joint for arm in seen.hands for joint in arm}
    for each in rl.find_periodic(motion.with_root_motion()):
        named = arms if each.limbs == "arms" else range(1, len(seen.names))
        yield Found(
            "closed" if each.closed else "cyclic",
            tuple(each.runs),
            each.period / motion.fps,
            each.repetitions,
            tuple(seen.names[joint] for joint in sorted(named)),
            None if each.closed else each.confidence,
        )
