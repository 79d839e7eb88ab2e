"""Base classes of the records of studies."""

from __future__ import annotations

import csv
import dataclasses
import os
from typing import Any, ClassVar

import numpy as np

from . import _html
from .histories import TimeSeries, _import

SCALARS = (str, bool, int, float)


def _scalars(of: Any) -> dict[str, Any]:
    """Return the fields of a record that are numbers or texts."""
    fields = ((f.name, getattr(of, f.name)) for f in dataclasses.fields(of))
    return {name: value for name, value in fields if isinstance(value, SCALARS)}


def _column(texts: list[str]) -> Any:
    try:
        return np.array([float(t) if t else np.nan for t in texts])
    except ValueError:
        return np.array(texts)


def _is_record(value: Any) -> bool:
    return dataclasses.is_dataclass(value) and not isinstance(value, type)


class RecordBase:
    """A part of a record. Lists of numbers are arrays; a quantity that was not measured is None."""

    _arrays: ClassVar[tuple[str, ...]] = ()

    def __post_init__(self) -> None:
        for name in self._arrays:
            if isinstance(getattr(self, name), list):
                setattr(self, name, np.asarray(getattr(self, name), dtype=np.float64))

    def _repr_html_(self) -> str:
        fields = dataclasses.fields(self)  # type: ignore[arg-type]
        shown = ((f.name, getattr(self, f.name)) for f in fields)
        rows = [(name, x) for name, x in shown if isinstance(x, SCALARS)]
        return _html.table(type(self).__name__, ["quantity", "value"], rows)


class RunBase(RecordBase):
    """A run, with the histories that it has recorded."""

    series: TimeSeries

    model: str
    integrator: str
    status: str
    steps: int

    def __repr__(self) -> str:
        return f"<Run of {self.model} under {self.integrator}: {self.status}, {self.steps} steps>"

    def _histories(self) -> TimeSeries:
        if not len(self.series):
            raise ValueError("the run has no histories")
        return self.series

    def to_pandas(self) -> Any:
        """Return the histories as a DataFrame (needs pandas)."""
        return self._histories().to_pandas()

    def to_xarray(self) -> Any:
        """Return the histories as a Dataset (needs xarray)."""
        return self._histories().to_xarray()

    def plot(self, *names: str, ax: Any = None, **style: Any) -> Any:
        """Draw histories over time (needs matplotlib)."""
        return self._histories().plot(*names, ax=ax, **style)


class StudyResult(RecordBase):
    """The record of a study: the keys of `results.json` as attributes.

    Attributes
    ----------
    exit_code : int
        Exit code of the command with these results.
    exit_meaning : str
        Meaning of the exit code.
    warnings : list of str
        Warnings of the study.
    folder : str or None
        Folder of the study, if it has written one.
    """

    scene: str
    runs: list[Any]
    exit_code: int = 0
    exit_meaning: str = ""
    warnings: list[str] = []
    folder: str | None = None
    _native: Any = None
    _keeps: Any = None

    def __getstate__(self) -> dict[str, Any]:
        """Return what a copy in another process has: all but the report and the files."""
        return {k: x for k, x in self.__dict__.items() if k not in ("_native", "_keeps")}

    def report(self, folder: str | os.PathLike[str]) -> str:
        """Write the folder of the study: the report `index.html`, `results.json`, tables and
        charts.

        Returns
        -------
        str
            Path of the report, which opens offline.
        """
        if self._native is None:
            raise ValueError("a copy of a result has no report: write that of the original")
        all_series = [[getattr(run, "series", None) for run in s.runs] for s in self._scenes()]
        series = [[None if s is None else (s.time_s, s.columns) for s in of] for of in all_series]
        path: str = self._native.report(os.fspath(folder), series)
        return path

    def to_rows(self, of: str | None = None) -> list[dict[str, Any]]:
        """Return a table of the record as a list of rows; of several scenes each row has its
        `scene`.

        Parameters
        ----------
        of : str, optional
            Name of the list; the runs, or else the first list of the study, if it is left out.
        """
        if of is None and getattr(self, "study", "") == "scan":
            columns = self.to_columns()
            return [dict(zip(columns, row)) for row in zip(*(x.tolist() for x in columns.values()))]
        rows = []
        for part in self._scenes():
            first = {"scene": part.scene} if self._scenes()[1:] else {}
            for entry in part._main() if of is None else getattr(part, of):
                own = dict(entry) if isinstance(entry, dict) else _scalars(entry)
                row = {**first, **own}
                for metrics in getattr(entry, "metrics", []):
                    values = _scalars(metrics)
                    against = values.pop("against", "")
                    row.update({f"{key} ({against})": x for key, x in values.items()})
                rows.append(row)
        return rows

    def _scenes(self) -> list[Any]:
        """Return the records of all scenes of the study, of one scene the record itself."""
        return [self, *getattr(self, "further", [])]

    def to_columns(self) -> dict[str, Any]:
        """Return the table of a scan, a row for each run.

        Returns
        -------
        dict of str to ndarray
            Columns of `cells.csv`: numbers as floats, other columns as texts.
        """
        if self.folder is None:
            raise ValueError("the study has no folder with a table of cells")
        with open(os.path.join(self.folder, "cells.csv"), encoding="utf-8", newline="") as file:
            rows = list(csv.reader(file))
        names, rows = rows[0], rows[1:]
        return {name: _column([row[i] for row in rows]) for i, name in enumerate(names)}

    def _main(self) -> list[Any]:
        if getattr(self, "runs", []):
            return list(self.runs)
        others = ("references", "measured", "mesh_modes", "runs", "machine", "source", "tolerance")
        parts = [self]
        for part in parts:
            for f in dataclasses.fields(part):  # type: ignore[arg-type]
                value = getattr(part, f.name)
                if part is self and f.name in others:
                    continue
                if isinstance(value, list) and value:
                    if _is_record(value[0]) or isinstance(value[0], dict):
                        return value
                elif _is_record(value):
                    parts.append(value)
        return []

    def to_pandas(self, of: str | None = None) -> Any:
        """Return a table of the record as a DataFrame (needs pandas); see `to_rows`."""
        return _import("pandas", "to_pandas").DataFrame(self.to_rows(of))

    def to_xarray(self, of: str | None = None) -> Any:
        """Return a table of the record as a Dataset (needs xarray); see `to_rows`."""
        _import("xarray", "to_xarray")
        return self.to_pandas(of).to_xarray()

    def plot(self, x: str | None = None, y: str | None = None, *, ax: Any = None) -> Any:
        """Draw the contact forces of the runs, or one column of the table over another.

        Parameters
        ----------
        x, y : str, optional
            Columns of `to_rows`. Without them the histories of the runs are drawn.

        Returns
        -------
        matplotlib.axes.Axes
        """
        if ax is None:
            _, ax = _import("matplotlib.pyplot", "plot").subplots()
        runs = [(s, r) for s in self._scenes() for r in getattr(s, "runs", [])]
        with_series = [(s, r) for s, r in runs if getattr(r, "series", None)]
        if x is None and y is None and with_series:
            for part, run in with_series:
                name = next(iter(run.series), None)
                if name is not None:
                    scene = f"{part.scene}: " if self._scenes()[1:] else ""
                    label = f"{scene}{run.model}, {run.integrator}"
                    run.series.plot(name, ax=ax, label=label)
            return ax
        rows = self.to_rows()
        numbers = [k for k, v in rows[0].items() if isinstance(v, float)] if rows else []
        x, y = x or (numbers[0] if numbers else None), y or (numbers[1] if numbers[1:] else None)
        if x is None or y is None:
            raise ValueError(
                "the record has no table with two columns of numbers: name `x` and `y`"
            )
        points = [(r[x], r[y]) for r in rows if r.get(x) is not None and r.get(y) is not None]
        ax.plot([p[0] for p in points], [p[1] for p in points], "o")
        ax.set_xlabel(x)
        ax.set_ylabel(y)
        return ax

    def _repr_html_(self) -> str:
        rows = self.to_rows()
        names: list[str] = []
        for row in rows:
            names += [n for n in row if n not in names]
        shown = names[:14]
        title = f"{type(self).__name__} of {self._names()}"
        return _html.table(title, shown, [[row.get(n) for n in shown] for row in rows])

    def __repr__(self) -> str:
        runs = sum(len(getattr(part, "runs", [])) for part in self._scenes())
        return f"<{type(self).__name__} of {self._names()}, {runs} runs>"

    def _names(self) -> str:
        return ", ".join(getattr(part, "scene", "") for part in self._scenes())
