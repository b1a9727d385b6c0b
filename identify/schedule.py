"""Where work runs: in this process, on this machine's cores, or on a Dask cluster.

All three hold pieces of data where they are worked on and give results in the pieces' order, so that sums
are formed in one order and come out the same to the last bit.
"""

import os
import pickle
import tempfile
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path
from typing import Any, Protocol

from threadpoolctl import threadpool_limits  # type: ignore[import-untyped]

from ..errors import InputError


class Scheduler(Protocol):
    """`place` puts values made from items where the work is done; the rest works on what was placed.

    Handles are opaque. Exceptions come through as they were raised.
    """

    def place(self, function: Callable[..., Any], items: Iterable[Any]) -> list[Any]:
        """Return a handle of function(item) for each item; items are taken as there is room."""
        ...

    def transform(self, function: Callable[..., Any], handles: Sequence[Any], *args: Any) -> list[Any]:
        """Return a handle of function(value, *args) for each handle."""
        ...

    def map(self, function: Callable[..., Any], handles: Sequence[Any], *args: Any) -> list[Any]:
        """Return function(value, *args) for each handle, in order."""
        ...


class Local:
    """Pieces as files in a temporary folder; `workers` processes, or this one when that is 1."""

    def __init__(self, folder: Path, pool: ProcessPoolExecutor | None, workers: int) -> None:
        self._folder, self._pool, self._workers, self._count = folder, pool, workers, 0

    def place(self, function: Callable[..., Any], items: Iterable[Any]) -> list[Any]:
        """See Scheduler; at most two items a worker are in memory at a time."""
        return list(self._bounded((_store, function, item, self._next()) for item in items))

    def transform(self, function: Callable[..., Any], handles: Sequence[Any], *args: Any) -> list[Any]:
        """See Scheduler."""
        return list(self._bounded((_transform, function, h, args, self._next()) for h in handles))

    def map(self, function: Callable[..., Any], handles: Sequence[Any], *args: Any) -> list[Any]:
        """See Scheduler."""
        return list(self._bounded((_apply, function, h, args) for h in handles))

    def _next(self) -> Path:
        self._count += 1
        return self._folder / f"{self._count}.pickle"

    def _bounded(self, calls: Iterable[tuple[Any, ...]]) -> Iterator[Any]:
        if self._pool is None:
            for function, *args in calls:
                yield _single_thread(function, *args)
            return
        waiting: deque[Future[Any]] = deque()
        for function, *args in calls:
            waiting.append(self._pool.submit(_single_thread, function, *args))
            while len(waiting) >= 2 * self._workers:
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()


class Dask:
    """Pieces as futures on the workers of a Dask cluster, which must have residuum installed."""

    def __init__(self, client: Any) -> None:
        self._client = client

    def place(self, function: Callable[..., Any], items: Iterable[Any]) -> list[Any]:
        """See Scheduler."""
        handles = []
        for item in items:
            data = self._client.scatter(item, hash=False)
            handles.append(self._client.submit(_single_thread, function, data, pure=False))
        return handles

    def transform(self, function: Callable[..., Any], handles: Sequence[Any], *args: Any) -> list[Any]:
        """See Scheduler."""
        return [self._client.submit(_single_thread, function, h, *args, pure=False) for h in handles]

    def map(self, function: Callable[..., Any], handles: Sequence[Any], *args: Any) -> list[Any]:
        """See Scheduler."""
        gathered: list[Any] = self._client.gather(self.transform(function, handles, *args))
        return gathered


@contextmanager
def scheduler(address: str | None = None, workers: int | None = None) -> Iterator[Scheduler]:
    """Open a place to work: the Dask cluster at `address` (host:port), else `workers` local processes.

    workers: default the cores that this process may use; 1 stays in this process.
    Raises InputError when Dask is not installed or the cluster does not answer.
    """
    if address is not None:
        with _client(address) as client:
            yield Dask(client)
        return
    count = (
        workers or len(os.sched_getaffinity(0))
        if hasattr(os, "sched_getaffinity")
        else workers or os.cpu_count() or 1
    )
    with tempfile.TemporaryDirectory(prefix="residuum-") as folder:
        if count == 1:
            yield Local(Path(folder), None, 1)
            return
        with ProcessPoolExecutor(count, mp_context=get_context("spawn")) as pool:
            try:
                yield Local(Path(folder), pool, count)
            finally:
                pool.shutdown(cancel_futures=True)


@contextmanager
def _client(address: str) -> Iterator[Any]:
    try:
        from dask.distributed import Client
    except ImportError:
        raise InputError('--scheduler: Dask is not installed; run pip install "residuum[cluster]"') from None
    client: Any
    try:
        client = Client(  # type: ignore[no-untyped-call]
            address, timeout="10s", set_as_default=False
        )
    except (OSError, ValueError, TimeoutError) as error:
        raise InputError(
            f"--scheduler {address}: no Dask scheduler answers there ({type(error).__name__}); give HOST:PORT"
        ) from None
    with client:
        yield client


def _single_thread(function: Callable[..., Any], *args: Any) -> Any:
    """Linear algebra on one thread: several processes share the cores, and sums keep their order."""
    with threadpool_limits(1):
        return function(*args)


def _store(function: Callable[..., Any], item: Any, path: Path) -> Path:
    with path.open("wb") as file:
        pickle.dump(function(item), file, protocol=5)
    return path


def _transform(function: Callable[..., Any], handle: Path, args: tuple[Any, ...], path: Path) -> Path:
    return _store(lambda value: function(value, *args), _load(handle), path)


def _apply(function: Callable[..., Any], handle: Path, args: tuple[Any, ...]) -> Any:
    return function(_load(handle), *args)


def _load(path: Path) -> Any:
    with path.open("rb") as file:
        return pickle.load(file)
