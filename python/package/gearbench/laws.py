"""Contact laws that are functions of Python."""

from __future__ import annotations

import inspect
import os
import re
from collections.abc import Callable, Mapping
from typing import Any

from .errors import SceneError

KEY = "normal_force"


class ContactLaw:
    """A contact law of one's own: the normal force of a tooth pair as a function.

    Parameters
    ----------
    function : callable
        ``function(gap, gap_rate)`` returns the compressive force over the whole face width [N], or
        a tuple of the force and its derivatives by the gap [N/m] and by the gap rate [N s/m].
        Derivatives that are not returned are computed by central differences. The gap [m] is zero
        or negative, the gap rate [m/s] is negative while flanks approach; a negative force counts
        as zero. A function with a third positional argument also receives the stiffness of the
        tooth pair [N/m] from the contact's ``stiffness``, one with a fourth the approach speed at
        first touch [m/s].
    name : str, optional
        Name in reports; that of the function if it is left out.
    potential : callable, optional
        ``potential(gap)`` or ``potential(gap, stiffness)`` returns the potential of the force at
        rest [J], zero at touch. If it is left out, the force is integrated.
    elastic : bool
        True if the force depends on the gap alone.

    ``gb.Contact(stiffness=..., normal_force=function)`` makes the law of a function alone. It is
    for `rigid` and `movable-teeth` gears.

    >>> ContactLaw(lambda gap, gap_rate: -2e8 * gap, name="spring", elastic=True)
    <ContactLaw spring>
    """

    def __init__(
        self,
        function: Callable[..., Any],
        *,
        name: str | None = None,
        potential: Callable[..., float] | None = None,
        elastic: bool = False,
    ) -> None:
        own = getattr(function, "__name__", type(function).__name__)
        self.name = name if name is not None else re.sub(r"[^\w-]", "", own)
        self.function = function
        self.potential = potential
        self.elastic = bool(elastic)
        # Studies go on after pieces with this law only, which the name alone does not identify.
        self._identity = os.urandom(16).hex()
        self._arguments = _positional(function, "a contact law", 2, 4, "(gap, gap_rate)")
        self._of_potential = 0
        if potential is not None:
            self._of_potential = _positional(potential, "a potential", 1, 2, "(gap)")

    @classmethod
    def of(cls, function: Callable[..., Any]) -> ContactLaw:
        """Return the law of a function; a law is returned as it is."""
        return function if isinstance(function, ContactLaw) else cls(function)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, ContactLaw):
            return NotImplemented
        own = (self.name, self.function, self.potential, self.elastic)
        return own == (other.name, other.function, other.potential, other.elastic)

    def __hash__(self) -> int:
        return hash((self.name, self.function))

    def __reduce__(self) -> Any:
        raise refusal([self.name], "sent to another process")

    def __repr__(self) -> str:
        return f"<ContactLaw {self.name}>"

    def _given(self) -> tuple[Any, ...]:
        """Return what the extension module receives."""
        potential = None if self.potential is None else (self.potential, self._of_potential)
        function = (self.function, self._arguments)
        return self.name, self._identity, function, potential, self.elastic


def _positional(of: Callable[..., Any], what: str, least: int, most: int, known: str) -> int:
    """Return the number of positional arguments of a function."""
    try:
        parameters = inspect.signature(of).parameters.values()
    except (TypeError, ValueError):
        return least
    kinds = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    free = [p for p in parameters if p.kind in kinds]
    required = sum(p.default is inspect.Parameter.empty for p in free)
    is_variable = any(p.kind is inspect.Parameter.VAR_POSITIONAL for p in parameters)
    if required > most or (len(free) < least and not is_variable):
        raise TypeError(f"{what} has {least} to {most} arguments, {known} first, not {len(free)}")
    return max(required, least)


def refusal(names: Any, what: str) -> SceneError:
    """Return the exception for a scene that only this program has."""
    law = ", ".join(f"`{name}`" for name in names)
    message = f"the scene has the contact law {law}, a function of Python, and cannot be {what}"
    help = (
        "keep the script that makes it, scan without an executor, or give the contact `exponent` "
        "and `damping`"
    )
    return SceneError(f"{message}\n  help: {help}", message=message, help=help)


def named(value: Any, laws: dict[str, ContactLaw]) -> Any:
    """Return a value with laws by their names, which are added to a dictionary."""
    if isinstance(value, ContactLaw):
        other = laws.setdefault(value.name, value)
        if other != value:
            message = f"two contact laws have the name `{value.name}`"
            help = 'give one of them another name: gb.ContactLaw(function, name="...")'
            raise SceneError(f"{message}\n  help: {help}", message=message, help=help)
        return value.name
    if isinstance(value, Mapping):
        return {key: named(x, laws) for key, x in value.items()}
    if isinstance(value, list):
        return [named(x, laws) for x in value]
    return value


def with_laws(value: Any, laws: Mapping[str, ContactLaw]) -> Any:
    """Return a value with laws in place of their names."""
    if isinstance(value, Mapping):
        return {
            key: laws.get(x, x) if key == KEY and isinstance(x, str) else with_laws(x, laws)
            for key, x in value.items()
        }
    if isinstance(value, list):
        return [with_laws(x, laws) for x in value]
    return value


def used(value: Any, laws: Mapping[str, ContactLaw]) -> dict[str, ContactLaw]:
    """Return the laws that a value names."""
    if isinstance(value, list):
        value = dict(enumerate(value))
    found: dict[str, ContactLaw] = {}
    for key, x in value.items() if isinstance(value, Mapping) else ():
        if key == KEY and x in laws:
            found[x] = laws[x]
        else:
            found.update(used(x, laws))
    return found
