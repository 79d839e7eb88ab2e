"""Reductions of gears to modes and static compliance, as arrays: those of gearbench, and those of
other programs.
"""

from __future__ import annotations

import atexit
import json
import os
import shutil
import tempfile
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _native
from .studies import words_of


class Reduction:
    """Flank nodes, modes and static compliance of a gear, with the names of the stored format
    (`.npz`).

    Parameters
    ----------
    meta : mapping
        Source, mount, teeth and other data in words.
    arrays : mapping of str to array_like
        Arrays in SI units: ``omega_rad_s`` of shape (modes,), ``shapes_per_sqrt_kg`` of shape
        (rows, modes), ``flank_compliance_m_per_n`` and others. The page on the format in the book
        lists all of them.

    A model takes a reduction as it is:
    ``gb.Model(model="elastic", parameters={"reduction": reduction})``.
    """

    meta: dict[str, Any]
    arrays: dict[str, npt.NDArray[Any]]

    def __init__(self, meta: Mapping[str, Any], arrays: Mapping[str, Any]) -> None:
        self.meta = dict(meta)
        self.arrays = {name: _stored(np.asarray(x)) for name, x in arrays.items()}
        self._path: str | None = None

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Reduction:
        """Read a stored reduction."""
        with np.load(path) as stored:
            arrays = {name: stored[name] for name in stored.files if name != "meta"}
            return cls(json.loads(stored["meta"].tobytes()), arrays)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the reduction; the model that reads it checks shapes and values."""
        text = json.dumps(self.meta, ensure_ascii=False).encode("utf-8")
        meta = np.frombuffer(text, dtype="|u1")
        with open(path, "wb") as file:
            np.savez(file, allow_pickle=False, meta=meta, **self.arrays)

    def replace(self, **arrays: Any) -> Reduction:
        """Return the reduction with other arrays."""
        return Reduction(self.meta, {**self.arrays, **arrays})

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        return self.arrays[name]

    def __fspath__(self) -> str:
        """Return the path of a file with the reduction, which exists until the program ends."""
        if self._path is None:
            folder = tempfile.mkdtemp(prefix="gearbench-reduction-")
            atexit.register(shutil.rmtree, folder, ignore_errors=True)
            path = os.path.join(folder, "gear.npz")
            self.save(path)
            self._path = path
        return self._path

    def __repr__(self) -> str:
        modes = len(self.arrays.get("omega_rad_s", ()))
        return f"<Reduction of {self.meta.get('source', 'a gear')}, {modes} modes>"


def _stored(values: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return an array in the form of the format: `<f8`, `<i8` or bytes, last axis fastest."""
    kinds = {"f": "<f8", "i": "<i8"}
    return np.asarray(values, dtype=kinds.get(values.dtype.kind, values.dtype), order="C")


_ARGUMENTS = next(s[2] for s in _native.study_arguments() if s[0] == "reduce")


def reduce(scene: Any, gear: str | None = None, **options: Any) -> Reduction:
    """Reduce a gear of a scene, or of a deck of finite elements, to modes and static compliance.

    Parameters
    ----------
    scene : Scene or str
        The scene, its name or path, or the path of a deck or a mesh.
    gear : str, optional
        Name of the gear; needed where a scene has several.
    **options
        Options of the command `gearbench reduce`, as ``modes``, ``max_frequency``, and ``matrices``
        for stiffness and mass that another program wrote.
    """
    from .scene import Scene, warn

    words = words_of(_ARGUMENTS, {"gear": gear, **options})
    is_scene = isinstance(scene, Scene)
    source = scene._source if is_scene else os.fspath(scene)
    with tempfile.TemporaryDirectory(prefix="gearbench-", ignore_cleanup_errors=True) as folder:
        path = os.path.join(folder, "gear.npz")
        answer = _native.run_study(
            ["reduce", source, *words, f"--out={path}"],
            [(source, scene._text)] if is_scene else [],
            None,
            scene._given_laws() if is_scene else [],
        )
        warn(answer["warnings"])
        if answer["stopped"] is not None:
            raise answer["stopped"]
        return Reduction.load(path)
