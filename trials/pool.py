"""Processes for the stages of a trial."""

import multiprocessing
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager

from threadpoolctl import threadpool_limits  # type: ignore[import-untyped]

Report = Callable[[int, int], None]  # (done, of)


@contextmanager
def pool(workers: int) -> Iterator[Executor]:
    """Give fresh processes with one thread each, or this one alone; an error drops what waits."""
    executor: Executor
    if workers > 1:
        context = multiprocessing.get_context("spawn")
        executor = ProcessPoolExecutor(workers, context, initializer=one_thread)
    else:
        executor = ThreadPoolExecutor(1)
    try:
        yield executor
    finally:
        executor.shutdown(cancel_futures=True)


def one_thread() -> None:
    """Keep linear algebra to one thread, for the whole of this process."""
    threadpool_limits(1)
