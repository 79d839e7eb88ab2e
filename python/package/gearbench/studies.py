"""Studies as calls, with the arguments of their commands.

Names, meanings, defaults and checks of arguments are those of the commands; nothing of it is
written here again.
"""

from __future__ import annotations

import difflib
import inspect
import itertools
import os
import pathlib
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from . import _native
from ._names import COMMANDS, STUDIES, python_name
from .errors import Interrupted
from .laws import ContactLaw, named

# Studies whose results are files besides the record: without `out` they have a folder that lives
# as long as the result.
WITH_FILES = ("choose", "scan")

# Commands whose input may be a file of another kind: of checks, a deck, or a gearbox of REXS.
OF_FILES = ("check", "mesh", "import")

# The shared library of FMUs, where a wheel contains it.
LIBRARY = next(pathlib.Path(__file__).parent.glob("*gearbench_fmu.*"), None)

Argument = tuple[str, str, str, str, bool, bool]


def _word(value: Any) -> str:
    """Return a value as the command line has it."""
    if isinstance(value, (str, os.PathLike)):
        return os.fspath(value)
    if isinstance(value, float):
        return repr(value)
    if hasattr(value, "tolist"):
        return _word(value.tolist())
    if isinstance(value, Sequence):
        return ",".join(_word(x) for x in value)
    return str(value)


def words_of(arguments: Sequence[Argument], options: Mapping[str, Any]) -> list[str]:
    """Return the options of a command line; an option that is None or False is left out."""
    known = {python_name(a[0]): a for a in arguments if not a[4]}
    words: list[str] = []
    for name, value in options.items():
        if name not in known:
            near = difflib.get_close_matches(name, known, n=1)
            hint = f"; did you mean `{near[0]}`?" if near else f"; there are {', '.join(known)}"
            raise TypeError(f"there is no argument `{name}`{hint}")
        option, repeated = known[name][0], known[name][5]
        if value is None or value is False:
            continue
        if value is True:
            words.append(f"--{option}")
        elif repeated and isinstance(value, Mapping):
            words += [f"--{option}={_word(k)}={_word(x)}" for k, x in value.items()]
        elif repeated and isinstance(value, Sequence) and not isinstance(value, str):
            words += [f"--{option}={_word(x)}" for x in value]
        else:
            words.append(f"--{option}={_word(value)}")
    return words


class _Bar:
    """Progress by tqdm."""

    def __init__(self, title: str) -> None:
        from tqdm.auto import tqdm

        self.bar = tqdm(desc=title)

    def __call__(self, done: int, total: int, what: str) -> None:
        self.bar.total = total or None
        self.bar.n = done
        self.bar.set_postfix_str(what, refresh=True)

    def close(self) -> None:
        self.bar.close()


def _observer(progress: Any, title: str) -> Any:
    if progress is True:
        try:
            return _Bar(title)
        except ImportError:
            return None
    return progress or None


def _record(fields: Mapping[str, Any]) -> Any:
    """Return a record of its fields, with those of further scenes."""
    from . import records

    further = [_record(of) for of in fields.get("further", [])]
    return records.RESULTS[fields["study"]](**{**fields, "further": further})


def result_of(command: str, answer: Mapping[str, Any], keeps: Any = None) -> Any:
    """Return the record of a study as an object."""
    from .scene import Scene

    made = _record(answer["fields"])
    made.exit_code, made.exit_meaning = answer["exit_code"], answer["exit_meaning"]
    made.warnings = answer["warnings"]
    made._native, made._keeps = answer["native"], keeps
    report = answer.get("report")
    made.folder = os.path.dirname(report) if report else None
    if command == "choose" and "scene" in answer:
        made.chosen = Scene.load(answer["scene"])
    return made


def sources_of(scenes: Sequence[Any]) -> list[str]:
    """Return the names by which a study loads its scenes, such as two changes of one file: each
    has a name of its own, in the folder from which its paths count."""
    found: list[str] = []
    for scene in scenes:
        path, name = pathlib.PurePath(scene._source), scene.name
        others = (str(path.with_name(f"{name}{end}.toml")) for end in _endings())
        found.append(next(s for s in itertools.chain([scene._source], others) if s not in found))
    return found


def _endings() -> Iterator[str]:
    yield ""
    yield from (f"-{n}" for n in itertools.count(2))


def execute(command: str, words: Sequence[str], scenes: Any, progress: Any, keeps: Any) -> Any:
    """Run a study by its words, in scenes by their sources, and return its record.

    Raises
    ------
    SceneError, RunFailed, Interrupted
        As `gearbench.errors` describes them.
    """
    from .scene import warn

    observer = _observer(progress, command)
    try:
        texts = [(source, scene._text) for source, scene in scenes.items()]
        laws: dict[str, ContactLaw] = {}
        for scene in scenes.values():
            named(list(scene._laws.values()), laws)
        given = [law._given() for law in laws.values()]
        answer = _native.run_study(list(words), texts, observer, given)
    except KeyboardInterrupt:
        raise Interrupted("interrupted before there was a result") from None
    finally:
        if isinstance(observer, _Bar):
            observer.close()
    warn(answer["warnings"], level=4)
    is_study = "fields" in answer
    result = result_of(command, answer, keeps) if is_study else answer["answer"]
    stopped = answer["stopped"]
    if isinstance(stopped, KeyboardInterrupt):
        raise Interrupted("interrupted: `result` has what was finished", result=result)
    if stopped is not None:
        raise stopped
    return result


def _takes_several(arguments: Sequence[Argument]) -> bool:
    return any(positional and repeated for *_, positional, repeated in arguments)


def _study(command: str, about: str, arguments: Sequence[Argument]) -> Callable[..., Any]:
    def study(scene: Any, *further: Any, progress: Any = None, **options: Any) -> Any:
        from .scene import Scene

        if further and not _takes_several(arguments):
            raise TypeError(f"`{command}` takes one scene, not {1 + len(further)}")
        if command in OF_FILES and not isinstance(scene, Scene):
            words = [command, os.fspath(scene), *words_of(arguments, options)]
            return execute(command, words, {}, progress, None)
        if not isinstance(scene, Scene):
            scene = Scene.load(scene)
        if command == "scan" and (options.get("executor") is not None or "shards" in options):
            from ._campaign import scan_in_shards

            return scan_in_shards(arguments, scene, progress, options)
        for name in ("executor", "retries"):
            options.pop(name, None) if command == "scan" else None
        if command == "fmu" and LIBRARY is not None and options.get("library") is None:
            options["library"] = LIBRARY
        keeps = None
        if command in WITH_FILES and options.get("out") is None:
            keeps = tempfile.TemporaryDirectory(prefix="gearbench-", ignore_cleanup_errors=True)
            options["out"] = os.path.join(keeps.name, command)
        scenes = [scene, *(s if isinstance(s, Scene) else Scene.load(s) for s in further)]
        sources = sources_of(scenes)
        words = [command, *sources, *words_of(arguments, options)]
        return execute(command, words, dict(zip(sources, scenes)), progress, keeps)

    name = python_name(command)
    study.__name__ = study.__qualname__ = name
    study.__doc__ = _documented(command, about, arguments)
    study.__signature__ = _signature(command, arguments)  # type: ignore[attr-defined]
    return study


def _documented(command: str, about: str, arguments: Sequence[Argument]) -> str:
    text = f"{about}.\n\nParameters\n----------\nscene : Scene or str\n"
    of_file = {
        "check": "The path of a file of checks.",
        "mesh": "A scene, or the path of a deck.",
        "import": "The path of a file of REXS.",
    }
    text += f"    {of_file.get(command, 'The scene, or its name or path.')}\n"
    for _, meaning, _, _, positional, repeated in arguments:
        if positional and repeated:
            text += f"*further : Scene or str, optional\n    {meaning}\n"
    text += "progress : callable or True, optional\n"
    text += "    Called with the pieces done, their number (0 if unknown) and the present one;\n"
    text += "    True for a bar of tqdm.\n"
    if command == "scan":
        text += "executor : concurrent.futures.Executor, optional\n"
        text += "    Runs the parts of the scan; each part is one future.\n"
        text += "shards : int, optional\n    Number of parts; four for each worker.\n"
        text += "retries : int\n    Number of times that a part is sent again, default 3.\n"
    kinds = {"flag": "bool"}
    for name, meaning, default, kind, positional, _ in arguments:
        if positional:
            continue
        text += f"{python_name(name)} : {kinds.get(kind, kind)}, optional\n"
        text += f"    {meaning}{f' [default: {default}]' if default else ''}\n"
    if command in COMMANDS:
        return text + "\nReturns\n-------\ndict\n    Paths of the files, and what was found.\n"
    return text + f"\nReturns\n-------\nrecords.{STUDIES[command]}\n"


def _signature(command: str, arguments: Sequence[Argument]) -> inspect.Signature:
    kind = inspect.Parameter.KEYWORD_ONLY
    own = [inspect.Parameter("scene", inspect.Parameter.POSITIONAL_OR_KEYWORD)]
    if _takes_several(arguments):
        own.append(inspect.Parameter("further", inspect.Parameter.VAR_POSITIONAL))
    names = ["progress"] + (["executor", "shards", "retries"] if command == "scan" else [])
    names += [python_name(a[0]) for a in arguments if not a[4]]
    return inspect.Signature(own + [inspect.Parameter(n, kind, default=None) for n in names])


for _command, _about, _arguments in _native.study_arguments():
    if _command in STUDIES or _command in COMMANDS:
        globals()[python_name(_command)] = _study(_command, _about, _arguments)
