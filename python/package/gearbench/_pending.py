"""Runs that are converted to Python when one of their fields is first used: a loop over many runs
stays fast.
"""

from __future__ import annotations

import threading
from typing import Any

from . import _native
from .records import Run

_CONVERSION = threading.RLock()


class PendingRun(Run):
    """A run before its conversion; it becomes a `Run` with the first use of an attribute."""

    @staticmethod
    def of(recorded: _native.RecordedRun) -> Run:
        """Return the run of a recorded one."""
        made = PendingRun.__new__(PendingRun)
        object.__setattr__(made, "_recorded", recorded)
        return made

    def __getattribute__(self, name: str) -> Any:
        own = object.__getattribute__(self, "__dict__")
        if "_recorded" in own:
            with _CONVERSION:
                recorded = own.pop("_recorded", None)
                if recorded is not None:
                    own.update(recorded.convert().__dict__)
                    object.__setattr__(self, "__class__", Run)
        return object.__getattribute__(self, name)

    def __setattr__(self, name: str, value: Any) -> None:
        self.__getattribute__("model")
        object.__setattr__(self, name, value)
