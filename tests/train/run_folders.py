"""Folders of runs without training: the shipped policy with other weights, and curves."""

import json
import pathlib

import numpy as np

from baselines.policies.files import save_policy
from baselines.policies.shipped import find_trained

EVALUATIONS = (100, 200, 300)


def write_run(folder: pathlib.Path, seed: int, **changes) -> pathlib.Path:
    """Write the folder of a run of this seed, and return it."""
    folder.mkdir(parents=True)
    arguments = {"scenario": "paper-single", "decisions": 300, "output": str(folder)} | changes
    told = {"arguments": arguments | {"seed": seed}}
    (folder / "run.json").write_text(json.dumps(told))
    policy = find_trained("ppo_single")
    noise = np.random.default_rng(seed).normal(0.0, 0.02, policy.weights.shape)
    save_policy(policy._replace(weights=policy.weights + noise), folder / "best.policy", {})
    curve = [
        {"decisions": n, "hours": 0.1, "jackknifed": 0.01 * seed, "goal 1 hit": n / 400 + seed / 50}
        for n in EVALUATIONS
    ]
    (folder / "curve.json").write_text(json.dumps(curve))
    return folder
