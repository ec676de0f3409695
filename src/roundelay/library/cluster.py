"""Work spread over machines by Dask: a worker that is lost costs a retry, a task that dies itself.

Tasks write their files, and their results are taken as they are done; few are under way at once.
Each is done in a child of its worker, so that one that dies takes no other along.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from itertools import islice
from typing import TYPE_CHECKING, Any, TypeVar

from roundelay.base.errors import RoundelayError
from roundelay.library.workers import Limits, in_child

if TYPE_CHECKING:
    from distributed import Client

__all__ = ["spread_by_dask"]

Task = TypeVar("Task")
Result = TypeVar("Result")

# Tasks that wait at the scheduler, a worker; and seconds until one must answer.
_AHEAD = 3
_PATIENCE = "20s"


def spread_by_dask(
    work: Callable[[Task], Result],
    tasks: Iterable[Task],
    cluster: str | int,
    lost: Callable[[Task], Result],
    *,
    limits: Limits,
    late: Callable[[Task], Result],
) -> Generator[Result]:
    """Yield ``work(task)`` of every task as it is done.

    Parameters
    ----------
    work : callable
        A function of a module. What it raises is raised here.
    tasks : iterable
    cluster : str or int
        The address of a scheduler, or how many workers to start here.
    lost : callable
        Gives the result of a task whose child died, or that lost several workers.
    limits : Limits
        What a task may take.
    late : callable
        Gives the result of a task that took longer.

    Raises
    ------
    RoundelayError
        If Dask is not installed.
    OSError
        If no scheduler answers, or it goes away.
    """
    with _connected(cluster) as client:
        yield from _results(client, work, iter(tasks), lost, limits, late)


@contextmanager
def _connected(cluster: str | int) -> Iterator[Client]:
    """Connect to a scheduler, or start workers here; end what was started."""
    if find_spec("distributed") is None:
        told = "expected Dask for --scheduler and --cluster, found none"
        raise RoundelayError(f"{told}; pip install distributed")
    import dask
    from distributed import Client, LocalCluster

    if isinstance(cluster, str):
        try:
            client = Client(cluster, timeout=_PATIENCE)
        except (OSError, TimeoutError, ValueError) as error:
            told = "expected a Dask scheduler, found none that answers"
            raise OSError(None, told, cluster) from error
        with client:
            yield client
        return
    quiet = {"distributed.admin.large-graph-warning-threshold": "1GB"}
    with (
        dask.config.set(quiet),
        LocalCluster(
            n_workers=cluster, threads_per_worker=1, dashboard_address=None, silence_logs="CRITICAL"
        ) as workers,
        Client(workers) as client,
    ):
        yield client


def _results(
    client: Client,
    work: Callable[[Task], Result],
    waiting: Iterator[Task],
    lost: Callable[[Task], Result],
    limits: Limits,
    late: Callable[[Task], Result],
) -> Iterator[Result]:
    from distributed import as_completed

    known: dict[Any, Task] = {}

    def sent(count: int) -> list[Any]:
        futures = []
        for task in islice(waiting, count):
            future = client.submit(in_child, work, task, lost, limits=limits, late=late, pure=False)
            known[future.key] = task
            futures.append(future)
        return futures

    done = as_completed(sent(_AHEAD * max(1, len(client.scheduler_info()["workers"]))))
    for future in done:
        result = _result(future, known.pop(future.key), lost)
        future.release()
        for one in sent(1):
            done.add(one)
        yield result


def _result(future: Any, task: Task, lost: Callable[[Task], Result]) -> Result:
    """Take a result; a task that went down with several workers is lost."""
    from concurrent.futures import CancelledError

    from distributed import KilledWorker
    from distributed.comm.core import CommClosedError

    try:
        return future.result()
    except KilledWorker:
        return lost(task)
    except (CancelledError, CommClosedError):
        told = "the Dask scheduler went away; run it again to go on"
        raise OSError(None, told, "cluster") from None
