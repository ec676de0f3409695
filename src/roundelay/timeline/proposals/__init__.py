"""Proposers: what may repeat, and where. None of them judges; all are asked, and one evidence
weighs what they propose.

A proposer is an object with a `name` and a method `propose`; see `Proposer`. Ours are

- ``recurrence``: a period of some limbs predicts the next (`recurrence`);
- ``excitation``: a class of the poses turns again and again, with something else between
  (`gestures`).
"""

from collections.abc import Sequence

from roundelay.base.registry import Registry
from roundelay.timeline.limbs import Body
from roundelay.timeline.proposals.gestures import Gestures
from roundelay.timeline.proposals.proposal import Candidate, Proposer
from roundelay.timeline.proposals.recurrence import Recurrence

__all__ = ["Candidate", "Proposer", "proposed", "proposers"]

proposers: Registry[Proposer] = Registry("proposer", "roundelay.proposers", Proposer)
proposers.add(Recurrence())
proposers.add(Gestures())


def proposed(body: Body, names: Sequence[str] | None = None) -> list[Candidate]:
    """Ask proposers, all by default.

    Parameters
    ----------
    body : Body
    names : sequence of str, optional

    Raises
    ------
    ValueError
        If there is no proposer of a name.
    """
    asked = proposers if names is None else [proposers[name] for name in names]
    return [candidate for proposer in asked for candidate in proposer.propose(body)]
