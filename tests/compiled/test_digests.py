"""The digest of code: changes of compiled code change it, and nothing else does."""

import importlib
import pathlib
import subprocess
import sys
import textwrap

import pytest

from baselines.evaluation.runs import run_part
from hav_env import OnAxle, RandomPoses, Task, make_policy
from hav_env.compiled import classes_in, digest_code
from hav_env.compiled.digests import _MACHINERY, _Walk
from hav_env.compiled.entries import _Compiled
from hav_env.compiled.sharing import _share
from hav_env.evaluation.rollout import rollout_worlds
from hav_env.policies import POLICIES
from hav_env.simulator.batch import begin_worlds
from hav_env.world.arrays import World
from tests.support.paths import ROOT

POLICY = """
    from typing import NamedTuple

    import parts_of_it
    from hav_env import act, sensing
    from parts_of_it import CONSTANT, helper


    class Mine(NamedTuple):
        gain: float = 1.0


    @act.register(Mine)
    def decide(policy, memory, world, agent, lane, sharp=2.0):
        '''Decide.'''
        first, second = parts_of_it.TABLE
        return first + policy.gain, CONSTANT * sharp + helper(0.5)
"""
HELPERS = """
    from hav_env.compiled import kernel

    CONSTANT, TABLE, UNUSED = 0.25, (1.0, 2.0), 1


    @kernel
    def helper(x):
        return 3.0 * x


    @kernel
    def aside(x):
        return 4.0 * x
"""


@pytest.fixture
def digest(tmp_path, monkeypatch):
    """Return a function from two modules of a user's to the digest of a rollout with them."""
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)

    def digest_of(policy=POLICY, helpers=HELPERS):
        (tmp_path / "policy_of_mine.py").write_text(textwrap.dedent(policy))
        (tmp_path / "parts_of_it.py").write_text(textwrap.dedent(helpers))
        for name in ("policy_of_mine", "parts_of_it"):
            sys.modules.pop(name, None)
        importlib.invalidate_caches()
        mine = importlib.import_module("policy_of_mine").Mine
        return digest_code([rollout_worlds], [mine, OnAxle, Task]).digest

    yield digest_of
    for name in ("policy_of_mine", "parts_of_it"):
        sys.modules.pop(name, None)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("'''Decide.'''", "'''Decide something else.'''"),
        ("first, second", "# a remark\n\n        first, second"),
        ("from typing", "# a remark\n    from typing"),
        ("UNUSED = 0.25, (1.0, 2.0), 1", "UNUSED = 0.25, (1.0, 2.0), 2"),
        ("4.0 * x", "5.0 * x"),
    ],
)
def test_comments_docstrings_and_what_is_not_called_change_nothing(old, new, digest):
    assert (POLICY + HELPERS).count(old) == 1
    assert digest() == digest(POLICY.replace(old, new), HELPERS.replace(old, new))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("sharp=2.0", "sharp=2.5"),
        ("0.5)", "0.6)"),
        ("CONSTANT * sharp", "CONSTANT + sharp"),
        ("0.25", "0.26"),
        ("(1.0, 2.0)", "(1.5, 2.0)"),
        ("3.0 * x", "3.5 * x"),
        ("@kernel\n    def helper", "@rare_kernel\n    def helper"),
    ],
)
def test_constants_calls_and_options_count_wherever_they_stand(old, new, digest):
    assert old in POLICY + HELPERS
    helpers = HELPERS.replace("import kernel", "import kernel, rare_kernel")
    assert digest(POLICY, helpers) != digest(POLICY.replace(old, new), helpers.replace(old, new))


def test_an_edited_policy_leaves_others_and_scenarios_as_they_are(digest):
    def others():
        return [
            digest_code([rollout_worlds], [type(make_policy("avoid_jack")), OnAxle, Task]).digest,
            digest_code([begin_worlds], [RandomPoses, Task]).digest,
        ]

    before, own = others(), digest()
    assert digest(POLICY.replace("0.5", "0.7")) != own
    assert others() == before


@pytest.mark.parametrize("name", POLICIES.names())
def test_drawings_figures_and_commands_are_in_no_digest(name):
    """For a table, the digest follows all its code, including Python code."""
    policy = make_policy(name)
    walk = _Walk(classes_in(policy, RandomPoses(), OnAxle(), Task()))
    for function in (run_part, rollout_worlds):
        walk.enter(function)
    walk.finish()
    modules = {fact.partition("\t")[0] for fact in walk.facts if "\t" in fact}
    aside = ("rendering", "figures", "cli", "replay", "envs", "experiments", "mdp.decision")
    assert "hav_env.evaluation.episode_table" in modules
    assert type(policy).__module__.rpartition(".")[0] in {m.rpartition(".")[0] for m in modules}
    assert not [module for module in modules if any(f".{part}" in module for part in aside)]


def test_models_that_choose_code_are_named():
    code = digest_code([rollout_worlds], [type(make_policy("avoid_jack")), OnAxle, Task, World])
    assert code.models == ("AvoidJack", "OnAxle")
    assert code.size > 10_000


TABULATE = """
    from typing import Any, NamedTuple


    class Column(NamedTuple):
        name: str
        values: Any


    COLUMNS = {"first": (Column("a", lambda rows: rows + 1.0), *[Column("b", max)])}


    def tabulate(rows):
        return {column.name: column.values(rows) for column in COLUMNS["first"]}
"""


def test_functions_in_tables_of_columns_count():
    def digest_of(text):
        found = {"__name__": "tables_of_mine"}
        exec(compile(textwrap.dedent(text), "tables_of_mine.py", "exec"), found)
        return digest_code([found["tabulate"]]).digest

    one = digest_of(TABULATE)
    assert one == digest_of(TABULATE.replace("COLUMNS =", "# a remark\n    COLUMNS ="))
    assert one != digest_of(TABULATE.replace("rows + 1.0", "rows + 2.0"))
    assert one != digest_of(TABULATE.replace('"b"', '"c"'))


STATE = """
    remembered, KNOWN = set(), {"a": 1}


    def tabulate(rows):
        remembered.add(rows)
        return KNOWN["a"]
"""


def test_what_a_process_remembers_does_not_count():
    found = {"__name__": "state_of_mine"}
    exec(compile(textwrap.dedent(STATE), "state_of_mine.py", "exec"), found)
    before = digest_code([found["tabulate"]]).digest
    found["tabulate"](1.0)
    again = {"__name__": "state_of_mine"}
    exec(compile(textwrap.dedent(STATE), "state_of_mine.py", "exec"), again)
    again["tabulate"](2.0)
    assert digest_code([again["tabulate"]]).digest == before
    other = {"__name__": "state_of_mine"}
    exec(compile(textwrap.dedent(STATE).replace("1}", "2}"), "state_of_mine.py", "exec"), other)
    assert digest_code([other["tabulate"]]).digest != before


IN_A_PROCESS = """
import json
from baselines.evaluation.runs import run_part
from hav_env import OnAxle, RandomPoses, Task, make_policy
from hav_env.compiled import classes_in, digest_code
{first}
models = [make_policy("reserve"), RandomPoses(), OnAxle(), Task()]
print(digest_code([run_part], classes_in(*models)).digest)
"""
FIRST = """
import numpy as np
import matplotlib, torch, hav_env, baselines.experiments.survey, baselines.figures.paper
from tests.support.policies import Weaving, Watched
from tests.support.worlds import side_by_side
hav_env.rollout("random", "paper-pair", 0, np.arange(2), Task(max_steps=3), threads=2)
hav_env.rollout(Weaving(), "swarm-5", 0, np.arange(2), Task(max_steps=3))
hav_env.parallel_env(scenario=side_by_side(2.0, 90.0), reward=Watched()).reset(seed=0)
"""


def test_a_digest_is_the_same_in_every_process():
    """It does not depend on earlier imports, compilations, trials and runs."""
    told = set()
    for first in ("", FIRST):
        done = subprocess.run(
            [sys.executable, "-c", IN_A_PROCESS.format(first=first)],
            capture_output=True, text=True, check=True, cwd=ROOT,
        )  # fmt: skip
        told.add(done.stdout.split()[-1])
    assert len(told) == 1


@pytest.mark.parametrize("around", [_Compiled(rollout_worlds.__wrapped__, 1).call, _share])
def test_code_around_every_loop_counts(around):
    function = getattr(around, "py_func", around)
    assert pathlib.Path(function.__code__.co_filename).name in _MACHINERY
