"""An audit of HAVs by brute force: it knows lengths, positions and headings, no policy.

After every step it checks the chains of all pairs, every joint, and all waiting HAVs. For near
chains it also checks the time between steps: wheels roll there, or axles move straight from place
to place.
"""

import itertools
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from baselines.policies.reserve import Reserve
from hav_env import Batch, Task
from hav_env.policies.driver import PolicyDriver

FAR = 0.5  # [m] chains whose boxes are farther apart are not measured
PIECES = 12  # parts of a step that are checked
CONTACT = 1e-9  # [m] chains that are nearer touch, but for rounding

Interference = Callable[[int, Any, np.ndarray, np.ndarray], None]


class Pose(NamedTuple):
    """Positions of all HAVs."""

    rear: np.ndarray  # (N, W) rear axle of the truck, x + iy [m]
    heading: np.ndarray  # (N, U, W) [rad]


def poses_of(worlds) -> Pose:
    """Return the present positions of all HAVs."""
    state = worlds.state
    return Pose(state.x + 1j * state.y, state.heading.copy())


def axles_of(worlds, pose: Pose | None = None) -> np.ndarray:
    """Return the axles (N, W, U + 1) of all chains, x + iy [m]; a short one repeats its last."""
    pose, fleet = pose or poses_of(worlds), worlds.fleet
    units = np.arange(fleet.length.shape[1])[:, None]
    length = np.where(units <= fleet.num_trailers[:, None], fleet.length, 0.0)
    unit = np.moveaxis(length * np.exp(1j * pose.heading), 1, 2)
    rear = pose.rear[..., None]
    behind = rear - np.cumsum(unit[..., 1:], axis=2)
    return np.concatenate([rear + unit[..., :1], rear, behind], axis=2)


def roll(worlds, pose: Pose, dt: float) -> Iterator[np.ndarray]:
    """Yield the axles on the way through the step that was just done, as wheels roll.

    They are eqs. (1) and (2) from where the step began, in ``PIECES``
    pieces by the midpoint rule.
    """
    state, length = worlds.state, worlds.fleet.length
    speed, steering = state.speed, state.steering

    def rates(heading: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        turning, v = np.zeros(heading.shape), speed
        turning[:, 0] = v * np.tan(steering) / length[:, 0]
        for unit in range(1, heading.shape[1]):
            bend = heading[:, unit] - heading[:, unit - 1]
            turning[:, unit] = -v * np.sin(bend) / length[:, unit]
            v = v * np.cos(bend)
        return turning, speed * np.exp(1j * heading[:, 0])

    h = dt / PIECES
    for _ in range(PIECES):
        turning, _ = rates(pose.heading)
        turning, velocity = rates(pose.heading + 0.5 * h * turning)
        pose = Pose(pose.rear + h * velocity, pose.heading + h * turning)
        yield axles_of(worlds, pose)


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


def pair_distances(axles, far: float = FAR) -> np.ndarray:
    """Return the distances (P, W) [m] of all pairs of chains; inf for those farther apart."""
    first, second = np.triu_indices(axles.shape[0], 1)
    gap = np.full((first.size, axles.shape[1]), -np.inf)
    for part in (axles.real, axles.imag):
        low, high = part.min(axis=2), part.max(axis=2)
        gap = np.maximum(gap, np.maximum(low[first] - high[second], low[second] - high[first]))
    distances = np.full(gap.shape, np.inf)
    pair, w = np.nonzero(gap <= far)
    if pair.size:
        distances[pair, w] = chain_distances(axles[first[pair], w], axles[second[pair], w])
    return distances


class Audit:
    """Findings in a batch, step by step.

    Attributes:
        largest: Articulation of each HAV (N, W) [rad].
        least: Distance of each pair (P, W) at a step [m]; inf for pairs that touched at the start.
        between: The same on the way from step to step.
        steps: Number of checked steps.
        restless: Number of HAVs that moved while they waited.
    """

    def __init__(self, worlds: Any, dt: float = 0.2) -> None:
        """Check the start; ``dt`` is the duration of a step [s]."""
        self.worlds, self.dt = worlds, dt
        self.pose, self.axles = poses_of(worlds), axles_of(worlds)
        self.touched = pair_distances(self.axles) <= CONTACT
        self.largest = joints_of(worlds).max(axis=1)
        self.least = np.full(self.touched.shape, np.inf)
        self.between = np.full(self.touched.shape, np.inf)
        self.waiting = worlds.state.waiting.copy()
        self.steps = self.restless = 0

    def look(self) -> None:
        """Check the results of a step."""
        axles, before = axles_of(self.worlds), self.axles
        moved = (axles != before).any(axis=2)
        self.restless += np.count_nonzero(moved & self.waiting)
        far = max(FAR, self._reach(axles))
        distances = np.where(self.touched, np.inf, pair_distances(axles, far))
        self.least = np.minimum(self.least, distances)
        self._look_between(axles, distances)
        self.largest = np.maximum(self.largest, joints_of(self.worlds).max(axis=1))
        self.pose, self.axles = poses_of(self.worlds), axles
        self.waiting = self.worlds.state.waiting.copy()
        self.steps += 1

    def _reach(self, axles: np.ndarray) -> float:
        """Return how much nearer [m] than at its end two chains may have been in a step."""
        return 2.5 * np.abs(axles - self.axles).max(initial=0.0)

    def _look_between(self, axles: np.ndarray, distances: np.ndarray) -> None:
        """Look into the step that led to these axles, in the worlds where chains are near."""
        if not (distances <= self._reach(axles)).any():
            return
        shares = np.arange(1, PIECES) / PIECES
        straight = (self.axles + share * (axles - self.axles) for share in shares)
        for way in itertools.chain(straight, roll(self.worlds, self.pose, self.dt)):
            found = np.where(self.touched, np.inf, pair_distances(way))
            self.between = np.minimum(self.between, found)

    def approve(self, rolls: bool = False) -> None:
        """Require no contact, no jackknife, and that waiting HAVs stand unless they may roll."""
        limit = np.abs(self.worlds.fleet.limit[:, 2])
        assert (self.largest < limit).all(), f"jackknife: {np.degrees(self.largest.max()):.1f} deg"
        least = np.minimum(self.least, self.between)
        assert (least > CONTACT).all(), f"contact of {np.argwhere(least <= CONTACT)}"
        assert rolls or self.restless == 0


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
        scenario: Scenario of the worlds.
        seed: Seed of their random numbers.
        episodes: Numbers of the episodes, one for each world.
        steps: Largest number of steps.
        policy: Policy that drives every HAV.
        task: Rules of the episodes.
        interfere: Function called with step, memory, speed and steering before each step, to change
            them.
    """
    batch = Batch(scenario, len(episodes), task)
    batch.reset(seed, np.asarray(episodes))
    driver, audit = PolicyDriver(policy, batch), Audit(batch.worlds, task.dt)
    for step in range(steps):
        speed, steering = driver.decide()
        if interfere is not None:
            interfere(step, driver.memory, speed, steering)
        batch.step(speed, steering)
        audit.look()
        if batch.worlds.state.waiting.all():
            break
    return audit
