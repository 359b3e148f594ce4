"""An audit of what HAVs do, by brute force: it knows lengths, positions and headings, no policy.

After every step it looks at the chains of all pairs, at every joint, and at HAVs that wait.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from baselines.driver import PolicyDriver
from baselines.reserve import Reserve
from hav_env import Batch, Task

FAR = 0.5  # [m] chains whose boxes are farther apart are not measured
CONTACT = 1e-9  # [m] chains that are nearer touch, but for rounding

Interference = Callable[[int, Any, np.ndarray, np.ndarray], None]


def axles_of(worlds) -> np.ndarray:
    """Return the axles (N, W, U + 1) of all chains, x + iy [m]; a short one repeats its last."""
    state, fleet = worlds.state, worlds.fleet
    units = np.arange(fleet.length.shape[1])[:, None]
    length = np.where(units <= fleet.num_trailers[:, None], fleet.length, 0.0)
    unit = np.moveaxis(length * np.exp(1j * state.heading), 1, 2)
    rear = (state.x + 1j * state.y)[..., None]
    behind = rear - np.cumsum(unit[..., 1:], axis=2)
    return np.concatenate([rear + unit[..., :1], rear, behind], axis=2)


def joints_of(worlds) -> np.ndarray:
    """Return the size of every articulation (N, U - 1, W) [rad], 0 where there is no joint."""
    joint = np.arange(worlds.state.heading.shape[1] - 1)[:, None]
    present = joint < worlds.fleet.num_trailers[:, None]
    return np.where(present, np.abs(np.diff(worlds.state.heading, axis=1)), 0.0)


def _to_segment(p, q, r) -> np.ndarray:
    """Return the squares of the distances from points p to segments from q to r."""
    way = r - q
    size = np.maximum((way * way.conj()).real, 1e-300)
    along = ((p - q) * way.conj()).real / size
    rest = p - q - np.clip(along, 0.0, 1.0) * way
    return (rest * rest.conj()).real


def _side(p, q, r) -> np.ndarray:
    return ((q - p).conj() * (r - p)).imag


def chain_distances(one, other) -> np.ndarray:
    """Return the distances (K,) [m] of K pairs of chains, axles (K, A) each; 0 if they cross."""
    a, b = one[:, :-1, None], one[:, 1:, None]
    c, d = other[:, None, :-1], other[:, None, 1:]
    squares = np.minimum(
        np.minimum(_to_segment(a, c, d), _to_segment(b, c, d)),
        np.minimum(_to_segment(c, a, b), _to_segment(d, a, b)),
    )
    cross = (_side(a, b, c) * _side(a, b, d) < 0) & (_side(c, d, a) * _side(c, d, b) < 0)
    return np.sqrt(np.where(cross, 0.0, squares).min(axis=(1, 2)))


def pair_distances(axles) -> np.ndarray:
    """Return the distances (P, W) [m] of all pairs of chains; inf for those far apart."""
    first, second = np.triu_indices(axles.shape[0], 1)
    gap = np.full((first.size, axles.shape[1]), -np.inf)
    for part in (axles.real, axles.imag):
        low, high = part.min(axis=2), part.max(axis=2)
        gap = np.maximum(gap, np.maximum(low[first] - high[second], low[second] - high[first]))
    distances = np.full(gap.shape, np.inf)
    pair, w = np.nonzero(gap <= FAR)
    if pair.size:
        distances[pair, w] = chain_distances(axles[first[pair], w], axles[second[pair], w])
    return distances


class Audit:
    """What was seen in a batch, step by step.

    Attributes:
        largest: articulation of each HAV (N, W) [rad].
        least: distance of each pair (P, W) [m]; inf for pairs that touched at the start.
        steps: how many were looked at.
        restless: how many HAVs moved while they waited.
    """

    def __init__(self, worlds: Any) -> None:
        """Look at the start."""
        self.worlds = worlds
        self.axles = axles_of(worlds)
        self.touched = pair_distances(self.axles) <= CONTACT
        self.largest = joints_of(worlds).max(axis=1)
        self.least = np.full(self.touched.shape, np.inf)
        self.waiting = worlds.state.waiting.copy()
        self.steps = self.restless = 0

    def look(self) -> None:
        """Look at what a step has led to."""
        axles, before = axles_of(self.worlds), self.axles
        moved = (axles != before).any(axis=2)
        self.restless += np.count_nonzero(moved & self.waiting)
        distances = np.where(self.touched, np.inf, pair_distances(axles))
        self.least = np.minimum(self.least, distances)
        self.largest = np.maximum(self.largest, joints_of(self.worlds).max(axis=1))
        self.axles, self.waiting = axles, self.worlds.state.waiting.copy()
        self.steps += 1

    def approve(self) -> None:
        """Demand no contact, no jackknife, and that who waits stands."""
        limit = np.abs(self.worlds.fleet.limit[:, 2])
        assert (self.largest < limit).all(), f"jackknife: {np.degrees(self.largest.max()):.1f} deg"
        assert (self.least > CONTACT).all(), f"contact of {np.argwhere(self.least <= CONTACT)}"
        assert self.restless == 0


def drive(
    scenario: Any,
    seed: int,
    episodes: Any,
    steps: int,
    *,
    policy: Any = Reserve(),
    task: Task = Task(),
    interfere: Interference | None = None,
) -> Audit:
    """Let a policy drive until all HAVs have arrived, and audit every step.

    Args:
        scenario, seed, episodes: which worlds; steps: how many at most.
        policy, task: what drives, and the rules.
        interfere: is called with step, memory, speed and steering before each step, to change them.
    """
    batch = Batch(scenario, len(episodes), task)
    batch.reset(seed, np.asarray(episodes))
    driver, audit = PolicyDriver(policy, batch), Audit(batch.worlds)
    for step in range(steps):
        speed, steering = driver.decide()
        if interfere is not None:
            interfere(step, driver.memory, speed, steering)
        batch.step(speed, steering)
        audit.look()
        if batch.worlds.state.waiting.all():
            break
    return audit
