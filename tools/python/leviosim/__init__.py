"""leviosim in Python: platforms, runs, replays, what-ifs and evaluations, in the process of the interpreter.

What a run yields is what the command `leviosim run` would write, file by file, as arrays and dictionaries:

    import leviosim
    gap9 = leviosim.Platform("gap9")
    run = leviosim.run(gap9, data="synthetic", frames="0:100", record=True)
    run["frame.latency.p50"]                       # a statistic by its name
    slow = run.replay(gap9.with_({"cluster.fpu.units": 1}))
    slow.table("stages")["cycles_parallel"]         # a column as an array; pandas.DataFrame takes all of it

Bad input raises InputError with the one line that the command prints. Between two frames Ctrl-C ends a run,
and `progress(done, total)` is called.
"""

from __future__ import annotations

import io
import csv
import html
import itertools
import json
import os
from typing import Any, Callable, Dict, Iterable, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np

from . import _core
from ._core import InputError

__version__: str = _core.version
Progress = Callable[[int, int], None]
Settings = Mapping[str, Union[str, int, float]]
Table = Dict[str, np.ndarray]

__all__ = ["InputError", "Platform", "Run", "Statistic", "check", "compare", "evaluate", "load", "platforms",
           "profiles", "replay", "run", "sweep", "tune", "whatif", "workload_parameters"]


def __dir__() -> List[str]:
    return sorted([*__all__, "__doc__", "__version__"])


class Statistic(NamedTuple):
    """A statistic of run.json."""

    name: str
    unit: str
    description: str
    value: Any


def _array(column: List[str]) -> np.ndarray:
    """Whole numbers, numbers with nan for what is empty, or text."""
    for kind in (np.int64, np.float64):
        try:
            filled = column if kind is np.int64 else [text or "nan" for text in column]
            return np.array([kind(text) for text in filled], dtype=kind)
        except ValueError:
            continue
    return np.array(column, dtype=str)


def _table(text: str) -> Table:
    rows = list(csv.reader(line for line in io.StringIO(text) if not line.startswith("# ")))
    if not rows:
        return {}
    return {name: _array([row[i] for row in rows[1:]]) for i, name in enumerate(rows[0])}


def _statistics(members: Dict[str, List[Any]]) -> Dict[str, Statistic]:
    return {name: Statistic(name, unit, description, value) for name, (value, unit, description, *_) in members.items()}


def _words(settings: Settings) -> List[str]:
    return [f"{path}={value}" for path, value in settings.items()]


# Of _repr_html_.
_SHOWN = ("frame.time.mean", "frame.time.p99", "frame.time.worst", "frame.missed_share", "memory.l1.peak",
          "memory.l2.peak", "energy.frame", "energy.mean_power", "accuracy.ate.rmse")


def _in_words(rows: Iterable[Tuple[str, float, str]]) -> Iterator[Tuple[str, float, str]]:
    """In the units that the commands print."""
    shown = {"ns": (1e-6, "ms"), "byte": (1e-3, "kB"), "B": (1e-3, "kB"), "1": (100, "%")}
    for what, value, unit in rows:
        scale, name = shown.get(unit, (1, unit))
        yield what, value * scale, name


class Platform:
    """A chip: the name of one that is built in, or a file, with what was set beyond it."""

    def __init__(self, name: str, set: Optional[Settings] = None) -> None:  # noqa: A002
        self.request = os.fspath(name)
        self.settings: Dict[str, Union[str, int, float]] = dict(set or {})
        self._resolved = _core.Platform(self.request, _words(self.settings))

    def with_(self, set: Settings) -> "Platform":  # noqa: A002
        """The same chip with other values: {"cluster.clock": "240MHz"}."""
        return Platform(self.request, {**self.settings, **set})

    @property
    def name(self) -> str:
        return self._resolved.name

    @property
    def description(self) -> str:
        return self._resolved.description

    def parameters(self) -> Dict[str, Dict[str, Any]]:
        """By path: value, unit, source, confidence, low, high, description."""
        return {row["path"]: row for row in self._resolved.parameters()}

    def __getitem__(self, path: str) -> Union[float, str]:
        """The value of a parameter, in the unit that parameters() gives."""
        value = self.parameters()[path]["value"]
        try:
            return float(value)
        except ValueError:
            return value

    def yaml(self) -> str:
        """The text of a platform file that gives the same chip."""
        return self._resolved.yaml()

    def area(self) -> Table:
        """Part by part in um2; empty for a chip without areas."""
        return _table(self._resolved.area_csv())

    def __repr__(self) -> str:
        return f"leviosim.Platform({self.request!r}, {self.settings!r})"


class Run(Mapping[str, Any]):
    """What a run or replay yielded. As a mapping: values of statistics by name."""

    def __init__(self, files: Dict[str, Union[str, bytes]]) -> None:
        self.files = files
        self.statistics: Dict[str, Statistic] = _statistics(json.loads(files["run.json"])["statistics"])

    def __getitem__(self, name: str) -> Any:
        return self.statistics[name].value

    def __iter__(self) -> Iterator[str]:
        return iter(self.statistics)

    def __len__(self) -> int:
        return len(self.statistics)

    def table(self, name: str) -> Table:
        """Of frames, stages, cycles, memory, energy, errors, replay: columns by name."""
        return _table(str(self.files[f"{name}.csv"]))

    @property
    def trajectory(self) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Times [s], positions [m], quaternions (x y z w) of the body."""
        rows = [line.split() for line in str(self.files["trajectory.tum"]).splitlines() if line[:1] != "#"]
        poses = np.array(rows, dtype=np.float64).reshape(-1, 8)
        return poses[:, 0], poses[:, 1:4], poses[:, 4:8]

    def replay(self, platform: Optional[Platform] = None, *, set: Optional[Settings] = None,  # noqa: A002
               progress: Optional[Progress] = None) -> "Run":
        """The recorded work on another chip; the run needs record=True."""
        return _replay("recording", self._recording(), platform, set, progress)

    def whatif(self, *changes: str, jobs: int = 1) -> Table:
        """A row per variant, as `leviosim whatif`; without a change its standard set."""
        return _table(_core.whatif_csv("recording", self._recording(), list(changes), jobs))

    def _recording(self) -> bytes:
        if "work.trace" not in self.files:
            raise InputError("the run holds no work.trace; expected run(..., record=True)")
        return bytes(self.files["work.trace"])  # type: ignore[arg-type]

    def _repr_html_(self) -> str:
        """For notebooks: what a run is asked for first."""
        rows = [(s.description or s.name, s.value, s.unit) for s in map(self.statistics.get, _SHOWN) if s is not None]
        cells = "".join(f"<tr><td>{html.escape(what)}</td><td style='text-align:right'>{value:.4g}</td>"
                        f"<td>{html.escape(unit)}</td></tr>" for what, value, unit in _in_words(rows))
        return f"<table>{cells}</table>"

    def __repr__(self) -> str:
        frame = self.statistics.get("frame.time.mean")
        time = f", {frame.value * 1e-6:.2f} ms a frame" if frame else ""
        return f"<leviosim.Run of {len(self.table('frames')['frame'])} frames{time}>"

    def plot(self, axes: Any = None) -> Any:
        """Latencies of all frames in ms; of a native run, its path from above. Needs matplotlib."""
        try:
            from matplotlib import pyplot
        except ImportError:
            raise InputError("plot() needs matplotlib: apt-get install python3-matplotlib, or pip install it") from None
        axes = axes if axes is not None else pyplot.gca()
        frames = self.table("frames")
        if "latency_ns" in frames:
            axes.plot(frames["frame"], frames["latency_ns"] * 1e-6)
            axes.set(xlabel="frame", ylabel="latency, ms")
        else:
            positions = self.trajectory[1]
            axes.plot(positions[:, 0], positions[:, 1])
            axes.set(xlabel="x, m", ylabel="y, m", aspect="equal")
        return axes

    def write(self, folder: str) -> None:
        """The files as the command leaves them, in a folder that is not there yet."""
        os.makedirs(folder)
        for name, content in self.files.items():
            data = content if isinstance(content, bytes) else content.encode()
            with open(os.path.join(folder, name), "xb") as out:
                out.write(data)


def load(folder: str) -> Run:
    """The run that a command or Run.write() left in a folder."""
    files: Dict[str, Union[str, bytes]] = {}
    try:
        for name in sorted(os.listdir(folder)):
            if not name.startswith(".") and name.endswith((".csv", ".json", ".tum", ".yaml", ".trace")):
                with open(os.path.join(folder, name), "rb") as file:
                    data = file.read()
                files[name] = data if name == "work.trace" else data.decode()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{folder}: {getattr(error, 'strerror', None) or error}; expected the folder of a run") from None
    if "run.json" not in files:
        raise InputError(f"{folder}: holds no run.json; expected the folder of a run")
    return Run(files)


def _record(run: Union[Run, str]) -> Union[str, bytes]:
    return (run if isinstance(run, Run) else load(run)).files["run.json"]


def compare(a: Union[Run, str], b: Union[Run, str], *, allow: Sequence[str] = ()) -> Dict[str, Any]:
    """As `leviosim compare --json`, of runs or their folders: figures, stages, and `why`. `allow`: what may differ besides
    the chip."""
    return json.loads(_core.compare_json(_record(a), _record(b), ",".join(allow)))


def check(run: Union[Run, str], budget: str, *, baseline: Union[Run, str, None] = None) -> Dict[str, Any]:
    """As `leviosim check --json` with a file of limits, of a run or its folder: `not_met` counts, `findings` say where and
    why."""
    return json.loads(_core.check_json(_record(run), os.fspath(budget), "" if baseline is None else _record(baseline)))


def tune(platform: Platform, clocks: Sequence[str], *, fps: float, data: str = "synthetic", profile: str = "levio",
         miss_rate: float = 0.05, ate: float = 0.2, seed: int = 1, frames: Optional[str] = None) -> Tuple[Table, Optional[str]]:
    """Closed loops at clocks such as "240MHz", at the chip's voltage and for one seed; `leviosim tune` takes several seeds
    and the lowest voltages. @returns a row per clock, and the lowest from which on all meet the limits"""
    rows: List[Dict[str, Any]] = []
    for clock in sorted(clocks, key=lambda text: float(text.rstrip("MHz"))):
        chip = platform.with_({"cluster.clock": clock, "controller.clock": clock})
        done = run(chip, data=data, profile=profile, fps=fps, deadline="drop", seed=seed, frames=frames)
        rows.append({"clock": clock, "missed_share": done["frame.missed_share"], "ate_rmse_m": done["accuracy.ate.rmse"],
                     "power_mw": done["energy.mean_power"], "frame_mean_ns": done["frame.time.mean"]})
    met = [row["missed_share"] <= miss_rate and row["ate_rmse_m"] <= ate for row in rows]
    lowest = next((rows[i]["clock"] for i in range(len(rows)) if all(met[i:])), None)
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}, lowest


def platforms() -> List[str]:
    """Names of the chips that are built in."""
    return list(_core.platform_names())


def profiles() -> Dict[str, str]:
    """Name and description of each profile of the workload."""
    return dict(_core.profiles())


def workload_parameters(profile: str = "levio") -> List[Dict[str, Any]]:
    """Name, value in the profile, unit, limits, description."""
    return list(_core.workload_parameters(profile))


def run(platform: Optional[Platform] = None, *, data: str = "synthetic", profile: str = "levio",
        frames: Optional[str] = None, cores: Optional[int] = None, seed: int = 1, size: str = "160x120",
        fps: Optional[float] = None, deadline: Optional[str] = None, initial_delay: Optional[float] = None,
        online: bool = False,
        set: Optional[Settings] = None, record: bool = False,  # noqa: A002
        progress: Optional[Progress] = None) -> Run:
    """As `leviosim run`; without a platform natively, without timing. `set`: {"workload.window": 6}.

    A row of `frames` says what its pose is worth (`state`): located, predicted, kept, or initialising, a guess."""
    words: Dict[str, Any] = {"data": data, "profile": profile, "seed": str(seed), "size": size,
                             "record": record, "online": online, "set": _words(set or {})}
    if platform is None:
        words["native"] = True
    else:
        words["platform"] = platform.request
        words["set"] = _words(platform.settings) + words["set"]
    optional = {"frames": frames, "cores": cores, "fps": fps, "deadline": deadline, "initial_delay": initial_delay}
    words.update({name: str(value) for name, value in optional.items() if value is not None})
    return Run(_core.run(words, progress))


def _replay(name: str, recording: bytes, platform: Optional[Platform], set: Optional[Settings],  # noqa: A002
            progress: Optional[Progress]) -> Run:
    settings = {**(platform.settings if platform else {}), **(set or {})}
    return Run(_core.replay(name, recording, platform.request if platform else "", _words(settings), progress))


def _bytes_of(recording: str) -> bytes:
    path = os.path.join(recording, "work.trace") if os.path.isdir(recording) else recording
    try:
        with open(path, "rb") as file:
            return file.read()
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}; expected a work trace, or the folder of a run with one") from None


def replay(recording: str, platform: Optional[Platform] = None, *, set: Optional[Settings] = None,  # noqa: A002
           progress: Optional[Progress] = None) -> Run:
    """A work trace, or the folder of a run with --record, on a chip [that of the recording]."""
    return _replay(recording, _bytes_of(recording), platform, set, progress)


def whatif(recording: str, *changes: str, jobs: int = 1) -> Table:
    """As Run.whatif(), of a work trace or the folder of a run."""
    return _table(_core.whatif_csv(recording, _bytes_of(recording), list(changes), jobs))


def sweep(over: Mapping[str, Sequence[Any]], point: Callable[[Dict[str, Any]], Run]) -> Iterator[Tuple[Dict[str, Any], Run]]:
    """All combinations, one after the other as they are asked for: sweep({"cluster.fpu.units": [1, 2]},
    lambda s: recorded.replay(gap9.with_(s)))."""
    for values in itertools.product(*over.values()):
        settings = dict(zip(over.keys(), values))
        yield settings, point(settings)


def evaluate(estimate: str, truth: str, *, align: str = "se3", relative: Sequence[float] = (40,)) -> Dict[str, Statistic]:
    """As `leviosim eval`: statistics by name. Files or folders; `relative`: lengths in m."""
    return _statistics(json.loads(_core.evaluate_json(os.fspath(estimate), os.fspath(truth), align, list(relative))))
