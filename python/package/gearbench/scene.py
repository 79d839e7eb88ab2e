"""Scenes as objects."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from . import _native, studies
from ._pending import PendingRun
from .errors import RunFailed, SceneWarning
from .laws import ContactLaw, named, refusal, used, with_laws
from .tables import Gear, Mesh, Model, Rack, Shaft, Study, Table, _plain

if TYPE_CHECKING:
    from . import records

Text = str | os.PathLike[str]
FIRST_FLANK = {"flank": "right", "gap_m": 0.0}


def warn(texts: Iterable[str], level: int = 3) -> None:
    """Issue warnings of a scene or a study."""
    for text in texts:
        warnings.warn(text, SceneWarning, stacklevel=level)


def shipped_scenes() -> list[str]:
    """Return the names of the scenes that are part of the package.

    >>> "spur_impact" in shipped_scenes()
    True
    """
    return _native.shipped_scenes()


def over_time(
    function: Callable[[float], float],
    duration_s: float,
    samples: int = 1001,
    key: str = "torque_nm",
) -> dict[str, Any]:
    """Return a load or a motion that follows a function of time.

    The function is called once for each sample, before the run, and values are linear between
    samples: a run takes as long as with a table of a file.

    Parameters
    ----------
    function : callable
        Value over time [s], in the unit of the key.
    duration_s : float
        Last time [s]; the last value holds after it.
    samples : int
        Number of evenly spaced samples.
    key : str
        Key of the values: ``torque_nm`` or ``force_n`` of loads, ``speed_rad_s`` or ``speed_m_s``
        of motions.

    >>> over_time(lambda t: 5.0 * t, 2.0, samples=3)
    {'table': {'time_s': [0.0, 1.0, 2.0], 'torque_nm': [0.0, 5.0, 10.0]}}
    """
    times = [duration_s * i / (samples - 1) for i in range(samples)]
    return {"table": {"time_s": times, key: [float(function(t)) for t in times]}}


class Parts:
    """Gears, meshes and shafts that belong together; parts of a scene.

    Parameters
    ----------
    gears : mapping of str to Gear or Rack
        Gears by name, in the order of the scene.
    meshes : sequence of Mesh
        Pairs of meshing gears.
    shafts : sequence of Shaft
        Shafts with several gears, or with bodies.
    """

    def __init__(
        self,
        gears: Mapping[str, Mapping[str, Any]],
        meshes: Sequence[Mapping[str, Any]] = (),
        shafts: Sequence[Mapping[str, Any]] = (),
    ) -> None:
        self.gears = dict(gears)
        self.meshes = list(meshes)
        self.shafts = list(shafts)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(self.gears)}; {len(self.meshes)} meshes)"


class Pair(Parts):
    """Two gears, or a gear and a rack, in mesh.

    Parameters
    ----------
    pinion, wheel : Gear or Rack
        The gears; a rack comes second.
    names : tuple of two str
        Names of the gears in the scene and in its records.
    **mesh
        Keys of the mesh, as ``centre_distance_m`` or ``backlash_m``; see `Mesh`.
    """

    def __init__(
        self,
        pinion: Mapping[str, Any],
        wheel: Mapping[str, Any],
        names: tuple[str, str] = ("pinion", "wheel"),
        **mesh: Any,
    ) -> None:
        a, b = names
        super().__init__({a: pinion, b: wheel}, [Mesh(gears=[a, b], **mesh)])


class Train(Parts):
    """Gears in a chain or on common shafts.

    Parameters
    ----------
    gears : mapping of str to Gear or Rack
        Gears by name.
    meshes : sequence of Mesh or of pairs of names, optional
        Pairs of meshing gears; each gear with the next one if it is left out.
    shafts : sequence of Shaft
        Shafts with several gears, or with bodies.
    **mesh
        Keys of the meshes that are given by names, as ``backlash_m``.
    """

    def __init__(
        self,
        gears: Mapping[str, Mapping[str, Any]],
        meshes: Sequence[Mapping[str, Any] | tuple[str, str]] | None = None,
        shafts: Sequence[Mapping[str, Any]] = (),
        **mesh: Any,
    ) -> None:
        names = list(gears)
        pairs: Sequence[Any] = meshes if meshes is not None else list(zip(names, names[1:]))
        made = [m if isinstance(m, Mapping) else Mesh(gears=list(m), **mesh) for m in pairs]
        super().__init__(gears, made, shafts)


class Planetary(Parts):
    """A planetary set: a sun, planets on the pins of a carrier, and a ring.

    Parameters
    ----------
    sun, planet, ring : Gear
        The gears; `ring` is an internal gear whose axis is at the origin.
    centre_distance_m : float or sequence of float
        Distance of the pins from the axis of the carrier, of each planet or of all [m].
    planets : int
        Number of planets.
    angles_deg : sequence of float, optional
        Angles of the pins; evenly spaced if it is left out.
    carrier : mapping
        Keys of the carrier as a body on its shaft, as ``inertia_kgm2``, ``speed_rad_s`` and
        ``loads``; see `Station`.
    start : mapping
        Start of the first mesh of a planet and the ring. The other meshes close loops, and follow.
    """

    def __init__(
        self,
        sun: Mapping[str, Any],
        planet: Mapping[str, Any],
        ring: Mapping[str, Any],
        *,
        centre_distance_m: float | Sequence[float],
        planets: int = 3,
        angles_deg: Sequence[float] | None = None,
        carrier: Mapping[str, Any],
        start: Mapping[str, Any] = FIRST_FLANK,
    ) -> None:
        names = [f"p{i + 1}" for i in range(planets)]
        if isinstance(centre_distance_m, (int, float)):
            distances = [float(centre_distance_m)] * planets
        else:
            distances = [float(d) for d in centre_distance_m]
        angles = [360.0 * i / planets for i in range(planets)] if angles_deg is None else angles_deg
        if len(distances) != planets or len(angles) != planets:
            raise ValueError(f"give one distance and one angle for each of the {planets} planets")
        at_origin = {"position_m": [0.0, 0.0], **ring}
        gears = {"sun": sun, **dict.fromkeys(names, planet), "ring": Gear(**at_origin)}
        inner = [
            Mesh(gears=["sun", name], centre_distance_m=d, direction_deg=float(a) or None)
            for name, d, a in zip(names, distances, angles)
        ]
        outer = [
            Mesh(gears=[name, "ring"], start=start if i == 0 else None)
            for i, name in enumerate(names)
        ]
        station = {"body": "carrier", "at_m": 0.0, "planets": names, **carrier}
        super().__init__(gears, [*inner, *outer], [Shaft(name="arm", carries=[station])])


class Simulation:
    """One model of a scene under one integrator, which is built once and runs as often as wanted.

    Made by `Scene.simulation`. `run` may be called from several threads.
    """

    def __init__(self, native: _native.Simulation) -> None:
        self._native = native

    @property
    def model(self) -> str:
        """Label of the model."""
        return self._native.model

    @property
    def method(self) -> str:
        """Integrator with its step or tolerance."""
        return self._native.method

    def run(self, observer: Callable[..., bool | None] | None = None) -> records.Run:
        """Run the model from the initial state of the scene.

        Parameters
        ----------
        observer : callable, optional
            Called after each accepted step with the time [s], the coordinates and the velocities
            (arrays, rad and m). The run ends where it returns True. A Python function costs about
            a microsecond a step.

        Returns
        -------
        records.Run
            The run with its histories, which are arrays that own what the run has written.

        Raises
        ------
        RunFailed
            If the run did not reach its end; `result` is the run up to there.
        """
        recorded, failure = self._native.run(observer)
        made = PendingRun.of(recorded)
        if failure is not None:
            raise RunFailed(f"{self.model} under {self.method}: {failure}", result=made)
        return made

    def __repr__(self) -> str:
        return f"<Simulation of {self.model} under {self.method}>"


class Scene:
    """Gears, meshes, the models to compare, and settings of studies.

    Parameters
    ----------
    *parts : Parts
        Pairs, trains and planetary sets, whose gears, meshes and shafts come first.
    **keys
        Keys of the scene file: ``name``, ``duration_s``, ``gears``, ``meshes``, ``models``,
        ``study`` and others.

    A scene does not change: `replace` and `changed` return another one. Scenes are equal if their
    files say the same.

    >>> import gearbench as gb
    >>> gear = gb.Gear(teeth=20, module_m=4e-3, face_width_m=10e-3, speed_rad_s=20.0)
    >>> pair = gb.Pair(gear, gear.replace(teeth=30, speed_rad_s=None), backlash_m=80e-6)
    >>> rigid = gb.Model(model="rigid", contact=gb.Contact(stiffness="iso6336"))
    >>> scene = gb.Scene(pair, name="impact", duration_s=1e-3, models=[rigid])
    >>> scene.gears["wheel"].teeth
    30
    """

    _source: str
    _text: str
    _tables: dict[str, Any] | None
    _simulations: dict[Any, Simulation]
    _laws: dict[str, ContactLaw]

    def __init__(self, *parts: Parts, **keys: Any) -> None:
        tables: dict[str, Any] = {"schema": 1, "gears": {}, "meshes": []}
        shafts: list[Any] = []
        for part in parts:
            tables["gears"].update(part.gears)
            tables["meshes"] += part.meshes
            shafts += part.shafts
        own = {key: x for key, x in keys.items() if x is not None}
        tables["gears"].update(own.pop("gears", {}))
        tables["meshes"] += list(own.pop("meshes", []))
        shafts += list(own.pop("shafts", []))
        tables = {**tables, **({"shafts": shafts} if shafts else {}), **own}
        source = f"{tables.get('name', 'scene')}.toml"
        laws: dict[str, ContactLaw] = {}
        plain = named(_plain(tables), laws)
        self._set(source, _native.write_scene(source, plain), laws)
        self._check()

    def _set(self, source: str, text: str, laws: Mapping[str, ContactLaw]) -> None:
        self._source, self._text = source, text
        self._tables = None
        self._simulations = {}
        self._laws = used(self._read(), laws) if laws else {}

    def _check(self) -> None:
        warn(_native.check_scene(self._source, self._text, self._given_laws()), level=4)

    def _given_laws(self) -> list[tuple[Any, ...]]:
        return [law._given() for law in self._laws.values()]

    @classmethod
    def _of(cls, source: str, text: str, laws: Mapping[str, ContactLaw] = {}) -> Scene:
        made = cls.__new__(cls)
        made._set(source, text, laws)
        return made

    @classmethod
    def load(cls, name: Text) -> Scene:
        """Load a scene by its path, or a shipped one by its name.

        Raises
        ------
        SceneError
            With file, line, what was expected, and the way out.
        """
        source = os.fspath(name)
        text, texts = _native.load_scene(source)
        warn(texts)
        return cls._of(source, text)

    @classmethod
    def parse(cls, text: str, name: str = "scene.toml") -> Scene:
        """Read a scene from the text of a file; paths in it count from the folder of `name`."""
        warn(_native.check_scene(name, text))
        return cls._of(name, text)

    def dump(self, path: Text | None = None) -> str:
        """Return the text of the scene file; it is written if a path is given.

        Raises
        ------
        SceneError
            If the scene has a contact law that is a function of Python.
        """
        if self._laws:
            raise refusal(self._laws, "written to a file")
        if path is not None:
            with open(path, "w", encoding="utf-8") as file:
                file.write(self._text)
        return self._text

    def _read(self) -> dict[str, Any]:
        if self._tables is None:
            self._tables = _native.read_scene(self._source, self._text)
        return self._tables

    @property
    def name(self) -> str:
        """Name of the scene."""
        return str(self._read()["name"])

    @property
    def duration_s(self) -> float:
        """Simulated time [s]."""
        return float(self._read()["duration_s"])

    @property
    def gears(self) -> dict[str, Any]:
        """Gears and racks by name, in the order of the scene."""
        gears = self._read()["gears"].items()
        return {n: (Rack if g.get("kind") == "rack" else Gear)._of(g) for n, g in gears}

    @property
    def meshes(self) -> list[Mesh]:
        """Pairs of meshing gears."""
        return [Mesh._of(m) for m in self._read().get("meshes", [])]

    @property
    def shafts(self) -> list[Shaft]:
        """Shafts with several gears or with bodies."""
        return [Shaft._of(s) for s in self._read().get("shafts", [])]

    @property
    def models(self) -> list[Model]:
        """Models to compare."""
        return [Model._of(with_laws(m, self._laws)) for m in self._read()["models"]]

    @property
    def study(self) -> Study:
        """Settings of studies."""
        made: Study = Study._of(self._read().get("study", {}))
        return made

    def __getitem__(self, key: str) -> Any:
        """Return the value of a key of the scene file."""
        return self._read()[key]

    def replace(self, **keys: Any) -> Scene:
        """Return the scene with other values of its keys; a key with None is left out."""
        tables = {k: x for k, x in {**self._read(), **keys}.items() if x is not None}
        laws: dict[str, ContactLaw] = {}
        plain = named(with_laws(_plain(tables), self._laws), laws)
        made = self._of(self._source, _native.write_scene(self._source, plain), laws)
        made._check()
        return made

    def changed(self, changes: Mapping[str, Any]) -> Scene:
        """Return the scene with other values at the paths of keys; comments and layout of its text
        stay.

        >>> scene = Scene.load("hammer").changed({"gears.pinion.speed_rad_s": 30.0})
        >>> scene.gears["pinion"].speed_rad_s
        30.0
        """
        laws = dict(self._laws)
        plain = named({k: _plain(x) for k, x in changes.items()}, laws)
        text = _native.change_scene(self._text, plain)
        made = self._of(self._source, text, laws)
        made._check()
        return made

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Scene):
            return NotImplemented
        same_laws = self._laws == other._laws
        return same_laws and _native.scenes_are_equal(self._text, other._text)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        if self._laws:
            raise refusal(self._laws, "sent to another process")
        return Scene._of, (self._source, self._text)

    def __repr__(self) -> str:
        return f"<Scene {self.name}: {', '.join(self._read()['gears'])}>"

    def _repr_html_(self) -> str:
        from . import _html

        rows = [
            [name, g.get("teeth"), g.get("module_m"), g.get("face_width_m"), g.get("speed_rad_s")]
            for name, g in self._read()["gears"].items()
        ]
        names = ["gear", "teeth", "module_m", "face_width_m", "speed_rad_s"]
        return _html.table(f"Scene {self.name}, {self.duration_s:g} s", names, rows)

    def simulation(
        self,
        model: str | None = None,
        method: str | None = None,
        *,
        samples: int | None = None,
        timeout: float | None = None,
        events: bool = True,
        histories: bool = False,
    ) -> Simulation:
        """Build one model under one integrator, to run it several times.

        Parameters
        ----------
        model : str, optional
            Label of the model; the first of the scene's study if it is left out.
        method : str, optional
            Integrator with step or tolerance, as ``dopri5@1e-6`` or ``trigonometric@1us``; that of
            the scene if it is left out.
        samples : int, optional
            Number of samples of the histories over the duration; that of the scene if it is left
            out.
        timeout : float, optional
            Bound on the processor time of the run [s].
        events : bool
            Locate contact events.
        histories : bool
            Also record the forces of tooth pairs, contact events and loads over the flanks, which
            takes longer than the run of rigid gears itself.
        """
        key = (model, method, samples, timeout, events, histories)
        known = self._simulations.get(key)
        if known is None:
            native = _native.Simulation(self._source, self._text, *key, self._given_laws())
            warn(native.warnings)
            if len(self._simulations) >= 4:
                self._simulations.clear()
            known = self._simulations[key] = Simulation(native)
        return known

    def run(
        self,
        model: str | None = None,
        method: str | None = None,
        *,
        observer: Callable[..., bool | None] | None = None,
        samples: int | None = None,
        timeout: float | None = None,
        events: bool = True,
        histories: bool = False,
    ) -> records.Run:
        """Run one model under one integrator; see `simulation` for the arguments and
        `Simulation.run` for the result.

        >>> run = Scene.load("hammer").run(model="rigid", method="dopri5@1e-6")
        >>> run.status
        'unchecked'
        """
        simulation = self.simulation(
            model,
            method,
            samples=samples,
            timeout=timeout,
            events=events,
            histories=histories,
        )
        return simulation.run(observer)

    compare = studies.compare
    choose = studies.choose
    precision = studies.precision
    stability = studies.stability
    truncation = studies.truncation
    stiffness = studies.stiffness
    modes = studies.modes
    response = studies.response
    sweep = studies.sweep
    run_up = studies.run_up
    scan = studies.scan
    identify = studies.identify
    coupling = studies.coupling
    penalty = studies.penalty
    cost = studies.cost
    mesh = studies.mesh
    reference = studies.reference
    fmu = studies.fmu
    export = studies.export


__all__ = ["Pair", "Parts", "Planetary", "Scene", "Simulation", "Table", "Train"]
