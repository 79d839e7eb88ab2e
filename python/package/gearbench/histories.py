"""Histories of a run as arrays that own the memory to which the run has written them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _html

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]


def _import(module: str, purpose: str) -> Any:
    import importlib

    try:
        return importlib.import_module(module)
    except ImportError as error:
        name = module.partition(".")[0]
        raise ImportError(f"{purpose} needs {name}: pip install {name}") from error


class TimeSeries(Mapping[str, FloatArray]):
    """Histories over a common time axis; a mapping of the names of columns to arrays.

    Parameters
    ----------
    time_s : ndarray, shape (n,)
        Times [s], not decreasing; two equal times are the two sides of a jump.
    columns : mapping of str to ndarray of shape (n,)
        Histories in SI units. A name ends in its unit, as ``contact_force_pinion_wheel_n``.
    """

    time_s: FloatArray
    columns: dict[str, FloatArray]
    # Where the run has written the histories.
    _written_at: dict[str, int]

    def __init__(self, time_s: Any = (), columns: Any = (), forces: Any = ()) -> None:
        self.time_s = np.asarray(time_s, dtype=np.float64)
        if isinstance(columns, Mapping):
            self.columns = dict(columns)
        else:
            self.columns = {c.name: np.asarray(c.values, dtype=np.float64) for c in columns}

    def __getitem__(self, name: str) -> FloatArray:
        if name == "time_s":
            return self.time_s
        try:
            return self.columns[name]
        except KeyError:
            names = ", ".join(self.columns)
            raise KeyError(f"there is no history `{name}`; there are {names}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)

    def __repr__(self) -> str:
        return f"TimeSeries({len(self.time_s)} samples of {', '.join(self.columns)})"

    def to_pandas(self) -> Any:
        """Return a DataFrame over the time axis (needs pandas)."""
        pandas = _import("pandas", "to_pandas")
        index = pandas.Index(self.time_s, name="time_s")
        return pandas.DataFrame(self.columns, index=index, copy=False)

    def to_xarray(self) -> Any:
        """Return a Dataset over the time axis, with units as attributes (needs xarray)."""
        xarray = _import("xarray", "to_xarray")
        names = self.columns.items()
        data = {n: ("time_s", x, {"units": unit_of(n)}) for n, x in names}
        return xarray.Dataset(data, coords={"time_s": ("time_s", self.time_s, {"units": "s"})})

    def plot(self, *names: str, ax: Any = None, **style: Any) -> Any:
        """Draw histories over time (needs matplotlib): the contact forces, or those of the names.

        Returns
        -------
        matplotlib.axes.Axes
        """
        if ax is None:
            _, ax = _import("matplotlib.pyplot", "plot").subplots()
        chosen = names or [n for n in self.columns if n.startswith("contact_force_")]
        for name in chosen or list(self.columns)[:1]:
            label = style.get("label", name)
            ax.plot(self.time_s, self[name], **{**style, "label": label})
            ax.set_ylabel(f"[{unit_of(name)}]")
        ax.set_xlabel("time [s]")
        ax.legend()
        return ax

    def _repr_html_(self) -> str:
        def row(name: str) -> list[Any]:
            values = self[name]
            ends = [float(np.min(values)), float(np.max(values))] if len(values) else [None, None]
            return [name, *ends]

        rows = [row(name) for name in self.columns]
        return _html.table(f"{len(self.time_s)} samples", ["history", "least", "greatest"], rows)


UNITS = {
    "rad_s": "rad/s",
    "n": "N",
    "m": "m",
    "nm": "N m",
    "pa": "Pa",
    "rad": "rad",
    "s": "s",
    "hz": "Hz",
    "j": "J",
    "w": "W",
    "m_s": "m/s",
}


def unit_of(name: str) -> str:
    """Return the unit at the end of a name: ``N`` of ``contact_force_pinion_wheel_n``."""
    parts = name.split("_")
    return UNITS.get("_".join(parts[-2:])) or UNITS.get(parts[-1], "-")


def _empty() -> Any:
    return np.empty(0)


@dataclass(kw_only=True)
class PairForces:
    """Forces of the tooth pairs in contact at the times of the grid.

    Attributes
    ----------
    time_s : ndarray, shape (n,)
        Times of the samples [s].
    mesh : ndarray of int, shape (n,)
        Mesh, from 1 in the order of the scene.
    teeth : ndarray of int, shape (n, 2)
        Teeth of both gears, from 1.
    force_n : ndarray, shape (n,)
        Magnitude of the contact force of the pair [N].
    """

    time_s: FloatArray = field(default_factory=_empty)
    mesh: IntArray = field(default_factory=_empty)
    teeth: IntArray = field(default_factory=_empty)
    force_n: FloatArray = field(default_factory=_empty)


@dataclass(kw_only=True)
class ContactEvents:
    """Contacts that close and open.

    Attributes
    ----------
    time_s : ndarray, shape (n,)
        Times of the events [s].
    closes : ndarray of bool, shape (n,)
        True if the contact closes, false if it opens.
    mesh : ndarray of int, shape (n,)
        Mesh, from 1 in the order of the scene.
    teeth : ndarray of int, shape (n, 2)
        Teeth of both gears, from 1.
    force_n : ndarray, shape (n, 2)
        Contact force of the mesh just before and just after the event [N].
    located : ndarray of bool, shape (n,)
        True if the time is that of a located event.
    """

    time_s: FloatArray = field(default_factory=_empty)
    closes: npt.NDArray[np.bool_] = field(default_factory=_empty)
    mesh: IntArray = field(default_factory=_empty)
    teeth: IntArray = field(default_factory=_empty)
    force_n: FloatArray = field(default_factory=_empty)
    located: npt.NDArray[np.bool_] = field(default_factory=_empty)
