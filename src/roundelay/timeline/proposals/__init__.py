"""Proposers: what may repeat, and where. None of them judges; the verdict does.

A proposer is an object with a `name` and a method `propose`; see `Proposer`. Ours are, in the
order in which they are asked,

- ``recurrence``: poses come back after a period (`recurrence`);
- ``closed``: the whole take is one period whose ends meet (`closed`);
- ``arms``: the arms alone recur (`recurrence`);
- ``gestures``: something recurs with something else between (`gestures`).
"""

from roundelay.base.registry import Registry
from roundelay.timeline.proposals.closed import Closed
from roundelay.timeline.proposals.gestures import Gestures
from roundelay.timeline.proposals.proposal import Proposal, Proposer
from roundelay.timeline.proposals.recurrence import Recurrence

__all__ = ["Proposal", "Proposer", "proposers"]

proposers: Registry[Proposer] = Registry("proposer", "roundelay.proposers", Proposer)
proposers.add(Recurrence("recurrence"))
proposers.add(Closed())
proposers.add(Recurrence("arms", limbs="arms"))
proposers.add(Gestures())
