"""This module follows drives in the simulator: one HAV per world, all worlds at a time.

The driver steers by the curvature of its path ahead, and by its distance from the path. It slows
down while the wheels turn.
"""

from typing import NamedTuple

import numpy as np

from baselines.sites.drives import Path
from hav_env import Batch, Task
from hav_env.scenarios.site_poses import SitePoses
from hav_env.vehicles import VEHICLES
from hav_env.world.arrays import PHASE

_AHEAD, _LOOK = 0.2, 0.4  # [m] and [s] of path over which the curvature is averaged
_SEARCHED = 20  # points of the path after the last one in which the nearest is searched
_FASTEST, _SLOWEST = 1.5, 0.1  # [m/s]
_WHEELS_OFF = 0.12  # [rad] between wanted and actual steering at which it is slowest


class Run(NamedTuple):
    """HAVs on their drives: W worlds, T steps."""

    poses: np.ndarray
    """(T, W, 2) positions of the trucks' rear axles [m]."""
    headings: np.ndarray
    """(T, W, U) headings of all units [rad]."""
    hit: np.ndarray
    """(W,) bool: whether all goals were hit."""
    off: float
    """Largest distance of a truck from its path [m]."""
    batch: Batch
    """Worlds at the end, with all records."""
    kinds: np.ndarray
    """(W,) numbers of the vehicles in the fleet."""
    places: np.ndarray
    """(W, 1 + G) numbers of the places, the start first."""


def places_in(scenario: SitePoses, batch: Batch, hav: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Return the vehicle (W,) of a HAV in each world, and its places (W, 1 + G).

    Args:
        scenario: Scenario of the batch.
        batch: Batch that has just been reset.
        hav: Index of the HAV.
    """
    worlds, fleet = batch.worlds, scenario.fleet
    lengths = worlds.fleet.length[hav].T[:, None]
    # rows of equal lengths: inf beyond the last unit on both sides
    kinds = (lengths == fleet.length[None]).all(axis=-1).argmax(axis=1)
    state = worlds.state
    start = np.stack([state.x[hav], state.y[hav], state.heading[hav, 0]], axis=-1)
    poses = np.concatenate([start[:, None], worlds.goals[hav].transpose(2, 0, 1)], axis=1)
    away = np.abs(poses[:, :, None] - scenario.place).max(axis=-1)
    return kinds, away.argmin(axis=-1)


def covering_episodes(
    scenario: SitePoses, seed: int, most: int
) -> tuple[np.ndarray, set[tuple[int, int, int]]]:
    """Return episodes in which HAV 0 drives all connections, and those (vehicle, from, to).

    Args:
        scenario: Scenario with one HAV.
        seed: Seed of the episodes.
        most: Number of episodes to choose from.
    """
    batch = Batch(scenario, most, vehicle=VEHICLES.make("realistic"))
    batch.reset(seed)
    kinds, places = places_in(scenario, batch)
    chosen: list[int] = []
    covered: set[tuple[int, int, int]] = set()
    for episode in range(most):
        legs = zip(places[episode], places[episode, 1:], strict=False)
        own = {(int(kinds[episode]), int(a), int(b)) for a, b in legs}
        if own - covered:
            covered |= own
            chosen.append(episode)
    return np.array(chosen), covered


def follow(
    scenario: SitePoses,
    names: tuple[str, ...],
    paths: list[Path],
    seed: int,
    episodes: np.ndarray,
    most_steps: int = 6_000,
) -> Run:
    """Drive HAV 0 of each episode from goal to goal along its drives.

    Args:
        scenario: Scenario with one HAV.
        names: Names of the vehicles of its fleet, in order.
        paths: Drives of all connections.
        seed: Seed of the episodes.
        episodes: (W,) numbers of the episodes.
        most_steps: Number of steps after which the run ends.
    """
    task = Task(max_steps=most_steps)
    batch = Batch(scenario, len(episodes), task, VEHICLES.make("realistic"))
    batch.reset(seed, episodes)
    state, fleet = batch.worlds.state, batch.worlds.fleet
    kinds, places = places_in(scenario, batch)
    number = {(names.index(path.vehicle), path.begin, path.end): k for k, path in enumerate(paths)}
    last = np.array([len(path.points) - 1 for path in paths])
    table = np.zeros((len(paths), last.max() + 1 + _SEARCHED, 4))
    for k, path in enumerate(paths):
        table[k] = path.points[-1]
        table[k, : last[k] + 1] = path.points
    wheelbase, world = fleet.length[0, 0], np.arange(len(episodes))
    tightest = np.array([1.0 / np.abs(path.points[:, 3]).max(initial=0.02) for path in paths])
    phase, at = np.full(len(world), -1), np.zeros(len(world), int)
    drive = np.zeros(len(world), int)
    poses, headings = [], []
    farthest = 0.0
    for _ in range(most_steps):
        poses.append(np.stack([state.x[0], state.y[0]], axis=-1))
        headings.append(state.heading[0].T.copy())
        now = state.goal[0, PHASE].astype(int)
        for w in np.flatnonzero(now != phase):
            drive[w] = number[int(kinds[w]), int(places[w, now[w]]), int(places[w, now[w] + 1])]
            at[w] = 0
        phase = now
        near = table[drive[:, None], at[:, None] + np.arange(_SEARCHED)]
        gap = ((near[..., :2] - poses[-1][:, None]) ** 2).sum(axis=-1)
        at = np.minimum(at + gap.argmin(axis=1), last[drive])
        x, y, heading, _ = table[drive, at].T
        aside = np.cos(heading) * (poses[-1][:, 1] - y) - np.sin(heading) * (poses[-1][:, 0] - x)
        turned = np.remainder(headings[-1][:, 0] - heading + np.pi, 2.0 * np.pi) - np.pi
        rolling = ~state.waiting[0]
        farthest = max(farthest, float(np.abs(aside[rolling]).max(initial=0.0)))
        count = np.maximum(1, ((_AHEAD + _LOOK * state.speed[0]) / 0.1).astype(int))
        spans = np.arange(_SEARCHED) <= count[:, None]
        ahead = np.minimum(at[:, None] + np.arange(_SEARCHED), last[drive][:, None])
        curvature = (table[drive[:, None], ahead, 3] * spans).sum(axis=1) / spans.sum(axis=1)
        firm = 2.0 / tightest[drive]
        curvature = curvature - firm * firm * aside - 2.0 * firm * turned
        steering = np.arctan(wheelbase * curvature)
        wheels_off = np.abs(steering - state.steering[0])
        speed = _FASTEST * np.clip(1.0 - wheels_off / _WHEELS_OFF, _SLOWEST, 1.0)
        batch.step(speed[None], steering[None])
        if batch.ended.all() and not (state.speed[0] > 0.0).any():
            break
    return Run(
        np.array(poses),
        np.array(headings),
        batch.worlds.state.waiting[0] & (phase == scenario.num_goals - 1),
        farthest,
        batch,
        kinds,
        places,
    )
