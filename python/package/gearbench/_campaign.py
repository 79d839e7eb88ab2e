"""A scan in parts, each a future of an executor."""

from __future__ import annotations

import json
import os
import pathlib
import queue
import tempfile
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import CancelledError, Executor, Future
from typing import Any

from . import _native
from .errors import GearbenchError, Interrupted, RunFailed
from .laws import refusal

RECORD = "results.json"
DEFAULT_RETRIES = 3
# Parts for each worker, so that one that ends early is not idle for long.
FOR_EACH_WORKER = 4


def run_part(source: str, text: str, words: Sequence[str]) -> dict[str, bytes]:
    """Run a part of a scan in a folder of its own, and return the files that it has written."""
    with tempfile.TemporaryDirectory(prefix="gearbench-", ignore_cleanup_errors=True) as folder:
        out = f"--out={os.path.join(folder, 'part')}"
        _native.run_study([*words, out], [(source, text)], None)
        part = pathlib.Path(folder, "part")
        return {path.name: path.read_bytes() for path in part.iterdir() if path.is_file()}


def _is_finished(folder: pathlib.Path, identity: Sequence[str], part: int, number: int) -> bool:
    """Return true if a folder holds this part of the scan with this identity."""
    try:
        record = json.loads((folder / RECORD).read_text(encoding="utf-8"))
        own, shard = record["identity"], record["shard"]
        found = (own["program"], own["scene"], own["arguments"])
        return found == tuple(identity) and (shard["number"], shard["of"]) == (part, number)
    except (OSError, ValueError, KeyError, TypeError):
        return False


def _workers(executor: Any) -> int:
    for name in ("_max_workers", "_num_workers"):
        known = getattr(executor, name, None)
        if isinstance(known, int) and known > 0:
            return known
    return os.cpu_count() or 1


class _Campaign:
    """Parts that are sent, received and sent again."""

    def __init__(self, make: Callable[[], Executor], retries: int) -> None:
        self.make = make
        self.executor = make()
        self.retries = retries
        self.ended: queue.Queue[tuple[int, Future[Any], Executor]] = queue.Queue()
        self.sent: dict[int, Future[Any]] = {}
        self.failures: dict[int, int] = {}

    def send(self, part: int, call: Sequence[Any]) -> None:
        """Send a part to a worker, with a new executor where the old one is broken."""
        try:
            future = self.executor.submit(run_part, *call)
        except RuntimeError:
            self.executor = self.make()
            future = self.executor.submit(run_part, *call)
        own = self.executor
        self.sent[part] = future
        future.add_done_callback(lambda done: self.ended.put((part, done, own)))

    def fails(self, part: int, error: BaseException) -> None:
        """Count a failure of a part, and raise it where it is one of the scene or one too many."""
        self.failures[part] = self.failures.get(part, 0) + 1
        if isinstance(error, GearbenchError):
            raise error
        if self.failures[part] > self.retries:
            raise RunFailed(
                f"part {part} of the scan failed {self.failures[part]} times: {error!r}"
            ) from error

    def stop(self) -> None:
        """Cancel all parts that have not begun."""
        for future in self.sent.values():
            future.cancel()


def scan_in_shards(
    arguments: Sequence[Any], scene: Any, progress: Any, options: Mapping[str, Any]
) -> Any:
    """Run a scan in parts by an executor, and join them.

    An executor that is a function without arguments is called for an executor, also in place of
    one that is broken by the death of a worker, as that of processes. An executor that replaces
    its workers is used as it is.
    """
    from .studies import _observer, execute, words_of

    own = dict(options)
    given, shards = own.pop("executor", None), own.pop("shards", None)
    retries = own.pop("retries", None)
    if given is None:
        raise TypeError("`shards` needs an `executor`")
    if scene._laws:
        raise refusal(scene._laws, "sent to the workers of an executor")
    made: Callable[[], Any] = given if not hasattr(given, "submit") else lambda: given
    campaign = _Campaign(made, DEFAULT_RETRIES if retries is None else int(retries))
    number = int(shards or FOR_EACH_WORKER * _workers(campaign.executor))
    keeps, out = None, own.pop("out", None)
    if out is None:
        keeps = tempfile.TemporaryDirectory(prefix="gearbench-", ignore_cleanup_errors=True)
        out = os.path.join(keeps.name, "scan")
    own.setdefault("threads", 1)
    words = ["scan", scene._source, *words_of(arguments, own)]
    parts = pathlib.Path(os.fspath(out) + ".parts")
    folders = {i: parts / f"{i:0{len(str(number))}}" for i in range(1, number + 1)}
    calls = {i: (scene._source, scene._text, [*words, f"--shard={i}/{number}"]) for i in folders}
    observer = _observer(progress, "scan")
    try:
        identity = _native.scan_identity(words, scene._source, scene._text)
        left = {i for i in folders if not _is_finished(folders[i], identity, i, number)}
        for part in sorted(left):
            campaign.send(part, calls[part])
        while left:
            try:
                part, future, by = campaign.ended.get(timeout=0.1)
            except queue.Empty:
                continue
            if part not in left or campaign.sent.get(part) is not future:
                continue
            try:
                files = future.result()
            except (CancelledError, Exception) as error:
                campaign.fails(part, error)
                campaign.send(part, calls[part])
                continue
            folders[part].mkdir(parents=True, exist_ok=True)
            # The record comes last: a folder with it is finished.
            for name in sorted(files, key=lambda n: n == RECORD):
                (folders[part] / name).write_bytes(files[name])
            left.discard(part)
            if observer is not None:
                observer(number - len(left), number, "parts")
    except KeyboardInterrupt:
        campaign.stop()
        raise Interrupted(
            f"interrupted: finished parts are in {parts}; the same call goes on after them"
        ) from None
    except BaseException:
        campaign.stop()
        raise
    finally:
        if hasattr(observer, "close"):
            observer.close()
    joined = ["merge", *(os.fspath(f) for f in folders.values()), f"--out={os.fspath(out)}"]
    result = execute("scan", joined, {}, None, keeps)
    for folder in folders.values():
        for path in folder.iterdir():
            path.unlink()
        folder.rmdir()
    parts.rmdir()
    return result
