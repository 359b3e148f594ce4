"""A policy file brings the filter and the guidance of its training along, wherever it drives."""

import re

import numpy as np
import pytest

from baselines.cli.titles import parts_of
from baselines.policies.files import load_policy, load_trained, save_policy
from baselines.policies.reserve import Reserve
from hav_env import Batch, Filtered, Task, find_scenario
from hav_env.evaluation.rollout import rollout
from hav_env.policies.backup import NoBackup
from hav_env.policies.driver import PolicyDriver
from hav_env.policies.filtered import filter_policy
from hav_env.safety import SafetyFilter, Unfiltered
from hav_env.vehicles import OnAxle
from tests.support.budgets import budget
from tests.support.networks import random_network

TASK = Task(max_steps=budget(60, 4))


@pytest.fixture
def path(tmp_path):
    file = tmp_path / "guided.policy"
    save_policy(random_network(4, guidance="feasible"), file, {}, "jackknife")
    return file


@pytest.mark.exhaustive
def test_a_file_with_a_filter_is_a_filtered_policy_for_any_rules(path):
    policy, episodes = load_policy(path), np.arange(budget(6, 1))
    assert isinstance(policy, Filtered)
    assert (policy.safety, policy.task, policy.vehicle) == (SafetyFilter("jackknife"), None, None)
    found = rollout(policy, "paper-single", 0, episodes, TASK)
    stated = filter_policy(policy.policy, "jackknife", TASK, OnAxle())
    assert found.equals(rollout(stated, "paper-single", 0, episodes, TASK, guidance="feasible"))


def test_a_file_keeps_the_backup_of_the_training(tmp_path):
    file = tmp_path / "backed.policy"
    for safety, made in ((None, Unfiltered()), ("jackknife", SafetyFilter("jackknife"))):
        save_policy(random_network(4), file, {}, safety, "reserve")
        policy = load_policy(file)
        assert isinstance(policy, Filtered)
        assert (policy.safety, policy.backup) == (made, Reserve())
    assert load_trained(file).backup == "reserve"


def test_another_filter_takes_the_place_of_that_of_the_file(path):
    policy = load_policy(path)
    again = filter_policy(policy, "both", TASK, OnAxle())
    assert again.policy is policy.policy
    assert again[1:] == (SafetyFilter("both"), TASK, OnAxle(), NoBackup())


def test_titles_of_tables_name_the_parts_of_a_policy(path):
    policy = load_policy(path)
    assert list(parts_of("mine", policy, False)) == [
        "mine: guidance=feasible",
        "mine: safety=jackknife",
    ]
    assert list(parts_of("mine", policy, True)) == ["mine: guidance=feasible"]
    assert not list(parts_of("mine", random_network(4), False))


def test_other_guidance_than_a_policy_reads_is_refused_in_one_line(path):
    told = "guidance is dubins, but must be feasible, which the policy reads"
    with pytest.raises(ValueError, match=re.escape(told)):
        rollout(load_policy(path), "paper-single", 0, np.arange(2), TASK, guidance="dubins")
    with pytest.raises(ValueError, match=re.escape(told)):
        PolicyDriver(load_policy(path), Batch(find_scenario("paper-single"), 1))


@pytest.mark.exhaustive
def test_a_policy_that_reads_no_guidance_drives_with_any():
    batch = Batch(find_scenario("paper-single"), 2, guidance="feasible")
    batch.reset(0)
    assert np.isfinite(PolicyDriver(random_network(4), batch).decide()).all()


@pytest.mark.parametrize("told", ["feasibly", 7])
def test_a_file_that_names_something_else_is_refused(told, tmp_path):
    file = tmp_path / "odd.policy"
    save_policy(random_network(4, guidance=told), file, {})
    with pytest.raises(ValueError, match=r"odd\.policy is no policy file.*guidance is"):
        load_policy(file)
