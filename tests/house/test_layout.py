"""The house holds: small folders, short files, floors above lower ones, one name one meaning."""

import ast
import collections
import importlib
import json
import pathlib
import subprocess
import sys
import tomllib

import pytest

import hav_env
from tests.support.paths import ROOT

TOPS = ("hav_env", "baselines", "train", "tests", "benchmarks", "examples")
MOST_MODULES, MOST_LINES = 14, 300


def sources(*tops):
    return [path for top in tops for path in sorted((ROOT / top).rglob("*.py"))]


def floors_of(container):
    """Return the floors of a package, the highest first, as pyproject.toml states them."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]
    for contract in contracts["contracts"]:
        if contract.get("containers") == [container]:
            return [layer.replace(" ", "").split("|") for layer in contract["layers"]]
    raise AssertionError(f"no floors of {container}")


@pytest.mark.parametrize("top", TOPS)
def test_no_folder_is_crowded(top):
    counts = collections.Counter(path.parent for path in sources(top) if path.name != "__init__.py")
    crowded = {str(folder): n for folder, n in counts.items() if n > MOST_MODULES}
    assert not crowded


def test_no_file_is_long():
    kinds = {".py", ".html", ".js", ".css", ".cpp", ".hpp", ".toml"}
    files = [p for top in TOPS for p in (ROOT / top).rglob("*") if p.suffix in kinds]
    lengths = {str(p): len(p.read_text().splitlines()) for p in files}
    assert not {path: n for path, n in lengths.items() if n > MOST_LINES}


# Each folder is imported in a process of its own. All are forked from one that has imported what
# takes long and is not of this project.
ALONE = """
import importlib, json, os, pkgutil, sys, types
import matplotlib.pyplot, numba, numpy, pyarrow.parquet, scipy.integrate, stable_baselines3, tyro

packages, root = json.loads(sys.argv[1]), sys.argv[2]
assert not {name.partition(".")[0] for name in sys.modules} & {package for package, _ in packages}

def import_alone(package, folder):
    bare = types.ModuleType(package)  # without what its own __init__ imports
    bare.__path__ = [f"{root}/{package}"]
    sys.modules[package] = bare
    found = importlib.import_module(f"{package}.{folder}")
    below = [] if folder == "rllib" else getattr(found, "__path__", [])
    for module in pkgutil.walk_packages(below, found.__name__ + "."):
        # Ray, TorchRL and BenchMARL are in an environment of their own, where they are tested
        if not module.name.endswith(("__main__", "envs.torchrl", "envs.benchmarl")):
            importlib.import_module(module.name)
    return sorted({name.split(".")[1] for name in sys.modules if name.startswith(package + ".")})

for package, folder in packages:
    child = os.fork()
    if child == 0:
        status = 1
        try:
            print(json.dumps([package, folder, import_alone(package, folder)]), flush=True)
            status = 0
        except BaseException:
            sys.excepthook(*sys.exc_info())
        finally:
            sys.stderr.flush()
            os._exit(status)
    os.waitpid(child, 0)
"""
FOLDERS = [
    (package, folder)
    for package in ("hav_env", "baselines", "train")
    for floor in floors_of(package)
    for folder in floor
    if folder != "__main__"
]


@pytest.fixture(scope="module")
def alone():
    """Return the folders that each folder imports, and the errors of those that failed."""
    done = subprocess.run(
        [sys.executable, "-c", ALONE, json.dumps(FOLDERS), str(ROOT)],
        capture_output=True, text=True, check=True, cwd=ROOT,
    )  # fmt: skip
    found = [json.loads(line) for line in done.stdout.splitlines()]
    return {(package, folder): names for package, folder, names in found}, done.stderr


@pytest.mark.parametrize(("package", "folder"), FOLDERS)
def test_each_folder_is_imported_alone_and_knows_lower_floors_only(package, folder, alone):
    imported, errors = alone
    assert (package, folder) in imported, errors[-2_000:]
    floors = floors_of(package)
    own = next(k for k, floor in enumerate(floors) if folder in floor)
    lower = {name for floor in floors[own + 1 :] for name in floor}
    assert set(imported[package, folder]) <= lower | {folder}


def constants_in(path):
    """Return the names of the constants that a module assigns."""
    names = set()
    for node in ast.parse(path.read_text()).body:
        targets = node.targets if isinstance(node, ast.Assign) else []
        targets = [node.target] if isinstance(node, ast.AnnAssign) else targets
        for target in targets:
            names |= {part.id for part in ast.walk(target) if isinstance(part, ast.Name)}
    return {name for name in names if name.isupper() and name.strip("_")}


def test_each_constant_has_one_meaning():
    where = collections.defaultdict(list)
    for path in sources("hav_env", "baselines", "train"):
        for name in constants_in(path):
            where[name].append(str(path.relative_to(ROOT)))
    public = {name: paths for name, paths in where.items() if name[0] != "_" and len(paths) > 1}
    assert not public
    twice = {f"_{name}": where[f"_{name}"] for name in where if f"_{name}" in where}
    assert not twice  # a private constant beside a public one of the same name


def test_functions_have_one_meaning():
    """A public function of the project is defined in one place."""
    where = collections.defaultdict(list)
    for path in sources("hav_env"):
        for node in ast.parse(path.read_text()).body:
            if isinstance(node, ast.FunctionDef) and node.name[0] != "_" and node.name != "main":
                where[node.name].append(str(path.relative_to(ROOT)))
    assert not {name: paths for name, paths in where.items() if len(paths) > 1}


def test_users_see_public_names_only():
    assert sorted(dir(hav_env)) == sorted([*hav_env.__all__, "__version__"])
    for name in hav_env.__all__:
        assert getattr(hav_env, name) is not None
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        hav_env.nothing  # noqa: B018


def unannotated(function):
    """Return the arguments of a function without a type."""
    arguments = function.args
    every = [*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs]
    every += [arg for arg in (arguments.vararg, arguments.kwarg) if arg]
    missing = [
        arg.arg for arg in every if arg.annotation is None and arg.arg not in ("self", "cls")
    ]
    return missing + ([] if function.returns or function.name == "__init__" else ["return"])


@pytest.mark.parametrize("name", [name for name in hav_env.__all__ if name != "sensing"])
def test_what_users_import_is_typed(name):
    found = getattr(hav_env, name)
    module = importlib.import_module(found.__module__)
    tree = ast.parse(pathlib.Path(module.__file__).read_text())
    nodes = {node.name: node for node in tree.body if hasattr(node, "name")}
    node = nodes[found.__name__]
    functions = [node] if isinstance(node, ast.FunctionDef) else node.body
    for function in functions:
        if isinstance(function, ast.FunctionDef) and (
            function.name[0] != "_" or function.name == "__init__"
        ):
            assert not unannotated(function), function.name


def test_sensing_is_typed():
    tree = ast.parse((ROOT / "hav_env/world/sensing.py").read_text())
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    assert len(functions) > 20
    assert not {f.name: unannotated(f) for f in functions if unannotated(f)}


def test_a_file_named_train_beside_a_script_is_in_nobodys_way(tmp_path):
    (tmp_path / "train.py").write_text("raise SystemExit('not this one')\n")
    (tmp_path / "baselines.py").write_text("raise SystemExit('nor this one')\n")
    script = tmp_path / "script.py"
    script.write_text(
        "from hav_env import HAVVecEnv, rollout, evaluate, make_policy, act, sensing\n"
        "print(HAVVecEnv(2, scenario='paper-pair').num_envs)\n"
    )
    done = subprocess.run(
        [sys.executable, str(script)], capture_output=True, text=True, check=False, cwd=tmp_path
    )
    assert done.stdout.strip() == "4", done.stderr
