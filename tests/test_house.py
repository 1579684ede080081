"""The house keeps its shape: imports point down only, rooms import the third parties they may, and the front door is light."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import anisogran

SOURCE = Path(anisogran.__file__).parent

# Rooms from the bottom up; rooms of one layer do not know each other.
LAYERS = [
    {"outcome", "glossary", "tensors", "compiled"},
    {"snapshot", "keys", "whole_file"},
    {"dem", "averaging", "models"},
    {"fitting", "continuum", "files"},
    {"scenes"},
    {"runs"},
    {"experiments"},
    {"comparison", "benchmark", "plots", "sweeps"},
    {"cost"},
    {"demo"},
    {"cli"},
    {"__main__"},
]
LEVEL = {room: level for level, rooms in enumerate(LAYERS) for room in rooms}
ALLOWED = {  # third parties that only these rooms may import
    "lmfit": {"fitting"},
    "skfem": {"continuum"},
    "matplotlib": {"plots"},
    "numba": {"compiled", "dem", "averaging", "models"},
    "llvmlite": {"compiled", "dem"},
    "typer": {"cli"},
    "rich": {"cli"},
}
OF_DEM = {"numpy", "numba", "llvmlite"}


def room_of(path):
    return path.relative_to(SOURCE).parts[0].removesuffix(".py")


def imports(path):
    """(room of anisogran or None, top-level package) of every import in a file."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            names = [f"{node.module}.{alias.name}" if node.module == "anisogran" else node.module for alias in node.names]
        else:
            continue
        for name in names:
            parts = name.split(".")
            inside = parts[0] == "anisogran" and len(parts) > 1 and parts[1] in LEVEL
            yield (parts[1] if inside else None), parts[0]


FILES = sorted(path for path in SOURCE.rglob("*.py") if path.name != "__init__.py" or path.parent != SOURCE)


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(SOURCE)))
def test_imports_point_down(path):
    room = room_of(path)
    assert room in LEVEL, f"{room} has no place in the house"
    for target, package in imports(path):
        if target is not None and target != room:
            assert LEVEL[target] < LEVEL[room], f"{path.relative_to(SOURCE)} imports {target}"
        assert room in ALLOWED.get(package, {room}), f"{path.relative_to(SOURCE)} imports {package}"
        if room == "dem" and package not in sys.stdlib_module_names | {"anisogran"}:
            assert package in OF_DEM, f"{path.relative_to(SOURCE)} imports {package}"


def test_front_door_is_light():
    """`import anisogran` loads nothing of weight, numpy included."""
    code = "import sys, anisogran; print(*sorted(sys.modules))"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert not {"numpy", "numba", "lmfit", "xarray", "matplotlib", "scipy", "skfem", "pydantic"} & set(loaded)


def test_every_public_name_resolves():
    for name in anisogran.__all__:
        assert getattr(anisogran, name) is not None
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        _ = anisogran.nonsense


def test_no_public_name_is_a_room():
    """A function that bears the name of a sub-module would hide it, or be hidden by it."""
    rooms = {path.stem for path in SOURCE.iterdir() if not path.name.startswith("_")}
    assert not (set(anisogran._NAMES) & rooms)


def test_nothing_is_hidden():
    """No silent repair of NaN, no bare except anywhere in the package."""
    for path in FILES:
        text = path.read_text()
        for word in ("nan_to_num", "except:"):
            assert word not in text, f"{path.relative_to(SOURCE)}: {word}"


def unsafe(tree):
    """What a source holds that runs or unpickles what a file or a text says."""
    modules = {"pickle", "cPickle", "_pickle", "cloudpickle", "dill", "joblib", "shelve", "marshal", "jsonpickle"}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else [node.module]
            yield from (name for name in names if name.split(".")[0] in modules)
        if isinstance(node, ast.Call):
            called = ast.unparse(node.func)
            pickles = {word.arg: word.value for word in node.keywords}.get("allow_pickle")
            if called in ("eval", "exec", "__import__", "read_pickle", "load_model", "os.system") or called.endswith(
                (".read_pickle", ".load_model")
            ):
                yield called
            if called in ("np.load", "numpy.load", "load") and pickles is None:
                yield f"{called} without allow_pickle=False"
            if pickles is not None and not (isinstance(pickles, ast.Constant) and pickles.value is False):
                yield f"{called} with allow_pickle"
            if any(word.arg == "shell" for word in node.keywords):
                yield f"{called} with a shell"
            if any(word.arg == "expr" for word in node.keywords):
                yield f"{called} with an expression"


@pytest.mark.hard_case("S1", "S2", "S7")
def test_nothing_is_unpickled_or_evaluated():
    for path in FILES:
        found = list(unsafe(ast.parse(path.read_text())))
        assert not found, f"{path.relative_to(SOURCE)}: {', '.join(found)}"


@pytest.mark.hard_case("S1", "S2", "S7")
@pytest.mark.parametrize(
    "code",
    [
        "import pickle", "from joblib import dump", "import shelve as s", "import dill.source", "eval('1')", "exec(text)", "np.load(path)",
        "np.load(path, allow_pickle=True)", "np.load(path, allow_pickle=x)", "npy.read_array(f, allow_pickle=1)", "pd.read_pickle(p)",
        "subprocess.run(c, shell=True)", "os.system(c)", "lmfit.Parameter('a', expr=text)",
    ],
)  # fmt: skip
def test_the_watch_is_awake(code):
    assert list(unsafe(ast.parse(code)))
