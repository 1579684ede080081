"""The folder of a sweep.

sweep.json       the scene, what is varied, and the values of each case by the name of its folder
NAME/scene.toml  the scene of a case, beside what its run leaves there, see runs/folder.py
lock             while a process runs the sweep
go               while cases are to run: they save themselves and stop when it is gone
"""

import json
from dataclasses import dataclass
from pathlib import Path

from anisogran.experiments.scene_file import read_scene, scene_from
from anisogran.files import write_json, write_text
from anisogran.outcome import InputError
from anisogran.runs.folder import made_folder, state_of
from anisogran.runs.session import differing, plain_scene
from anisogran.scenes.changes import changed
from anisogran.scenes.writing import scene_text
from anisogran.sweeps.cases import NAME, case_name, case_scenes, text_of

OF_A_BEGINNING = {"lock", "sweep.json.tmp"}  # what a sweep that was killed at once may have left


@dataclass(frozen=True)
class SweepFolder:
    """scene: the Experiment; vary: {key: [values]}; cases: {name: (values in the order of the keys)}."""

    path: Path
    scene: object
    vary: dict
    cases: dict

    def states(self):
        """A dict for each case: `case` (its name), `values` by key, and `state`, `fraction`, `message`, `stage`, ... of its run."""
        keys = list(self.vary)
        return [
            {"case": name, "values": dict(zip(keys, values, strict=True)), **state_of(self.path / name)}
            for name, values in self.cases.items()
        ]

    def write(self):
        """Writes sweep.json."""
        vary, cases = dict(self.vary), {name: list(values) for name, values in self.cases.items()}
        write_json(self.path / "sweep.json", {"scene": scene_text(self.scene), "vary": vary, "cases": cases})


def sweep_status(folder):
    """How the cases of the sweep in a folder are, a list of dicts, see SweepFolder.states. Raises InputError if there is no sweep."""
    return read_sweep(folder).states()


def read_sweep(folder):
    """The SweepFolder of a folder. Raises InputError, one line with the file, if there is none or it is damaged."""
    path = Path(folder) / "sweep.json"
    try:
        told = json.loads(path.read_text(encoding="utf-8"))
        scene = scene_from(told["scene"], str(path))
        cases = {name: tuple(values) for name, values in told["cases"].items()}
        vary, scenes = case_scenes(scene, dict(told["vary"]))
    except (FileNotFoundError, NotADirectoryError):
        raise InputError(f"{folder}: is no sweep, it has no sweep.json") from None
    except (OSError, ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
        reason = str(error).removeprefix(f"{path}: ") if isinstance(error, InputError) else f"damaged, {' '.join(repr(error).split())}"
        raise InputError(f"{path}: {reason}") from None
    bad = next((name for name in cases if not NAME.fullmatch(name)), None)
    if bad is not None:
        raise InputError(f"{path}: {bad!r} is no name of a case")
    if sorted(map(repr, cases.values())) != sorted(map(repr, scenes)):
        raise InputError(f"{path}: its cases are not those of what is varied")
    return SweepFolder(Path(folder), scene, vary, cases)


def check_sweep_folder(folder):
    """Raises InputError if a folder holds something that is no sweep, or is none."""
    try:
        folder = Path(folder)
    except TypeError:
        raise InputError(f"folder {folder!r} is no path") from None
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder}: is no folder")
    if folder.is_dir() and not (folder / "sweep.json").exists() and {one.name for one in folder.iterdir()} - OF_A_BEGINNING:
        raise InputError(f"{folder}: is neither empty nor a sweep (it has no sweep.json); choose another folder")


def taken_up(folder, scene, vary):
    """The SweepFolder of a new sweep, or of the one that is there with the values that have been added; its folders are made.

    Raises InputError if what is there is of another scene, or varies other keys, or has values that are not asked for now.
    """
    vary, scenes = case_scenes(scene, vary)
    if not (folder / "sweep.json").exists():
        there = SweepFolder(folder, scene, vary, {})
    else:
        there = read_sweep(folder)
        if set(there.vary) != set(vary):
            raise InputError(f"{folder}: is a sweep of {', '.join(there.vary)}, not of {', '.join(vary)}")
        for key, values in there.vary.items():
            lost = [text_of(value) for value in values if value not in vary[key]]
            if lost:
                raise InputError(f"{folder}: has {key} = {', '.join(lost)}; values can be added to a sweep, not left out")
        vary, scenes = case_scenes(scene, {key: vary[key] for key in there.vary})
        first = {key: values[0] for key, values in there.vary.items()}
        asked, stored = (plain_scene(changed(one, first)) for one in (scene, there.scene))
        unlike = [text for _, text in differing("", asked, stored)]
        if unlike:
            raise InputError(f"{folder}: is a sweep of another scene: {'; '.join(unlike)}")
    name_of = {values: name for name, values in there.cases.items()}
    taken = set(there.cases)
    cases = {}
    for values in scenes:
        name = name_of.get(values) or case_name(dict(zip(vary, values, strict=True)), taken)
        taken.add(name)
        cases[name] = values
    sweep = SweepFolder(folder, there.scene, vary, cases)
    if cases != there.cases:
        sweep.write()
    for name, values in cases.items():
        _write_scene(folder / name, scenes[values])
    return sweep


def _write_scene(folder, scene):
    """Writes the scene of a case. Raises InputError if another one is there."""
    path = made_folder(folder) / "scene.toml"
    if not path.exists():
        write_text(path, scene_text(scene))
        return
    unlike = [text for _, text in differing("", plain_scene(scene), plain_scene(read_scene(path)))]
    if unlike:
        raise InputError(f"{path}: is not the scene of this case: {'; '.join(unlike)}")


def fraction_of(folder):
    """How far the run of a case is, 0 to 1, without looking whether it is at work: it may be about to take its lock."""
    try:
        return float(json.loads((folder / "state.json").read_text(encoding="utf-8"))["fraction"])
    except FileNotFoundError:
        return 0.0
