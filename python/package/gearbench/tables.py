"""Tables of scenes: a class for each, whose keywords are the keys of the scene file.

The keys, their units and their checks are those of the types that read scene files; nothing of it
is written here again.
"""

from __future__ import annotations

import inspect
import os
from collections.abc import Iterator, Mapping
from typing import Any

from . import _native
from ._names import TABLES, key_of, python_name
from .laws import ContactLaw, named


def _plain(value: Any) -> Any:
    """Return a value with tables as dictionaries."""
    if isinstance(value, Mapping):
        return {key: _plain(x) for key, x in value.items() if x is not None}
    if isinstance(value, (list, tuple)):
        return [_plain(x) for x in value]
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    if callable(value):
        return ContactLaw.of(value)
    return value


class Table(Mapping[str, Any]):
    """A table of a scene; its keys are attributes, and None where a key is left out.

    A table does not change: `replace` returns another one.
    """

    _type = ""
    _keys: tuple[str, ...] = ()
    _fixed: Mapping[str, Any] = {}

    def __init__(self, **keys: Any) -> None:
        given = {**self._fixed, **{key_of(key): x for key, x in keys.items()}}
        values = {key: _plain(x) for key, x in given.items() if x is not None}
        object.__setattr__(self, "_values", values)
        if self._type:
            checked = {k: x for k, x in values.items() if k not in self._fixed}
            _native.check_keys(self._type, named(checked, {}))

    @classmethod
    def _of(cls, values: Mapping[str, Any]) -> Any:
        """Return the table of values that the reader of scenes has checked."""
        made = cls.__new__(cls)
        object.__setattr__(made, "_values", dict(values))
        return made

    def __getitem__(self, key: str) -> Any:
        return self._values[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __getattr__(self, key: str) -> Any:
        if key.startswith("_"):
            raise AttributeError(key)
        key = key_of(key)
        if key in self._values:
            return self._values[key]
        if key in self._keys or not self._keys:
            return None
        raise AttributeError(f"{type(self).__name__} has no key `{key}`")

    def __setattr__(self, key: str, value: Any) -> None:
        raise AttributeError(f"a table does not change; use replace({key}=...)")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._keys]

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Mapping):
            return NotImplemented
        return bool(self._values == _plain(other))

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (type(self).__name__, dict(self._values))

    def __repr__(self) -> str:
        keys = ", ".join(f"{k}={x!r}" for k, x in self._values.items() if k not in self._fixed)
        return f"{type(self).__name__}({keys})"

    def replace(self, **keys: Any) -> Any:
        """Return the table with other values; a key with None is left out."""
        changed = {key_of(key): x for key, x in keys.items()}
        return type(self)(**{**self._values, **changed})


def _restored(name: str, values: dict[str, Any]) -> Any:
    return globals()[name]._of(values)


def _documented(about: str, keys: list[tuple[str, str, str, bool]]) -> str:
    text = f"{about}\n\nParameters\n----------\n"
    for key, meaning, _, required in keys:
        text += f"{python_name(key)}{'' if required else ' : optional'}\n    {meaning}\n"
    return text


def _made(name: str, rust: str, keys: list[tuple[str, str, str, bool]]) -> type[Table]:
    about = f"A table of a scene: the keys that the type `{rust}` reads."
    kind = inspect.Parameter.KEYWORD_ONLY
    fields: dict[str, Any] = {
        "__doc__": _documented(about, keys) if keys else about,
        "__module__": __name__,
        "_type": rust,
        "_keys": tuple(key for key, *_ in keys),
        "_fixed": {"kind": "rack"} if name == "Rack" else {},
    }
    made = type(name, (Table,), fields)
    if keys:
        parameters = [
            inspect.Parameter(
                python_name(key), kind, default=inspect.Parameter.empty if required else None
            )
            for key, _, _, required in keys
        ]
        made.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    return made


_DESCRIBED = dict(_native.scene_tables())
for _rust, _name in TABLES.items():
    globals()[_name] = _made(_name, _rust, _DESCRIBED.get(_rust, []))
