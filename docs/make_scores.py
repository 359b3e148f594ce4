"""This module scores every shipped policy on every named scenario, for the pages of scenarios."""

import json
import pathlib

import numpy as np
import pyarrow as pa

from hav_env import Task, find_scenario, make_policy, rollout
from hav_env.policies.names import POLICIES
from hav_env.scenarios.presets import FIELDS, SCENARIOS, SITES
from hav_env.vehicles import VEHICLES

SCORES = pathlib.Path(__file__).parent / "catalogue" / "scores.json"
EPISODES, SEED, MOST_STEPS = 20, 0, 5_000
MOST_HAVS = 400  # of all episodes of a score: large swarms have fewer episodes
SLOW, MOST_HAVS_OF_SLOW = ("context", "ppo_reserve", "ppo_swarm"), 10  # of a scenario
SHARES = ("jackknifed", "actual_collision", "obstacle_collision", "goal_1_hit", "goal_2_hit")


def vehicle_of(name: str) -> str:
    """Return the name of the vehicle model that a scenario is made for."""
    return "on_axle" if name in SCENARIOS else "realistic"


def count_episodes(name: str) -> int:
    """Return how many episodes a score has."""
    return min(EPISODES, max(1, MOST_HAVS // find_scenario(name).num_havs))


def score(policy: str, name: str) -> dict[str, float] | str:
    """Return shares of HAVs by name, or why the policy cannot drive there."""
    if policy in SLOW and find_scenario(name).num_havs > MOST_HAVS_OF_SLOW:
        return "it was not measured, for it takes long in large swarms"
    models = Task(max_steps=MOST_STEPS), VEHICLES.make(vehicle_of(name))
    try:
        made = make_policy(policy)
        table: pa.Table = rollout(
            made, find_scenario(name), SEED, np.arange(count_episodes(name)), *models
        )
    except (ValueError, TypeError) as error:
        return str(error)
    found = [field for field in SHARES if field in table.column_names]
    return {field: float(np.mean(table[field].to_numpy())) for field in found}


def main() -> None:
    """Measure, and write ``docs/catalogue/scores.json`` after every scenario."""
    scores: dict[str, dict] = json.loads(SCORES.read_text()) if SCORES.exists() else {}
    policies = [name for name in POLICIES.names() if not name.startswith(".")]
    for name in SCENARIOS | FIELDS | SITES:
        row = scores.setdefault(name, {})
        for policy in policies:
            if policy not in row:
                row[policy] = score(policy, name)
                print(name, policy, row[policy], flush=True)
        SCORES.write_text(json.dumps(scores, indent=1, sort_keys=True) + "\n")


if __name__ == "__main__":
    main()
