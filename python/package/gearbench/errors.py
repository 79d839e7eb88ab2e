"""Exceptions, with the texts of the command line: message, line of the scene, and the way out."""

from __future__ import annotations

from typing import Any


class GearbenchError(Exception):
    """A call that has no result.

    Attributes
    ----------
    message : str
        The message in one sentence.
    line : int or None
        Line of the scene's text, from 1, where the error has a place there.
    help : str or None
        The way out.
    result : object or None
        The partial result, where there is one.
    """

    def __init__(
        self,
        text: str,
        *,
        message: str | None = None,
        line: int | None = None,
        help: str | None = None,
        result: Any = None,
    ) -> None:
        super().__init__(text)
        self.message = message if message is not None else text
        self.line = line
        self.help = help
        self.result = result

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (type(self), str(self), self.message, self.line, self.help)


def _again(
    kind: type[GearbenchError], text: str, message: str, line: int | None, help: str | None
) -> GearbenchError:
    return kind(text, message=message, line=line, help=help)


class SceneError(GearbenchError, ValueError):
    """A scene, or an argument of a study, is refused."""


class RunFailed(GearbenchError, RuntimeError):
    """A computation failed. `result` is the run up to the failure, where there is one."""


class Interrupted(KeyboardInterrupt):
    """A study was interrupted. `result` has the parts that were finished, or is None.

    Attributes
    ----------
    result : object or None
        The finished parts.
    """

    def __init__(self, text: str = "interrupted", *, result: Any = None, **_: Any) -> None:
        super().__init__(text)
        self.result = result


class SceneWarning(UserWarning):
    """A value of a scene is valid and not plausible, or a part of a study was left out."""
