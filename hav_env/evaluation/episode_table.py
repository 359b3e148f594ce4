"""The table of an evaluation: one row for each HAV and episode, columns as in docs/metrics.md."""

import numpy as np
import pyarrow as pa

from hav_env.policies.interface import joint_weights
from hav_env.world.arrays import (
    ACTUAL,
    CLOSEST,
    DUBINS,
    EPISODE,
    EUCLIDEAN_MISS,
    FOOTPRINT,
    HEADING_MISS,
    HIT_DISTANCE,
    HIT_HEADING,
    HIT_PATH,
    HIT_STEP,
    JACKKNIFE,
    LARGEST,
    MISS_ARTICULATION,
    MISS_COUNT,
    MISS_DISTANCE,
    MISS_HEADING,
    MOVED,
    NEVER,
    PATH,
    POTENTIAL,
    STABLE,
    STEP,
    WHEN,
    WHERE,
    World,
)


def tabulate(worlds: World, start: np.ndarray, policy) -> pa.Table:
    """Turn the records of ended episodes into rows, in the order of episodes and HAVs.

    Args:
        worlds: the batch at the end of its episodes.
        start: (N, 3, W) the start poses.
        policy: whose jackknife weights are reported; the paper's for policies without.
    """
    num_havs, num_worlds = worlds.state.x.shape

    def rows(values: np.ndarray) -> np.ndarray:
        """(N, ..., W) -> (W * N, ...)."""
        shape = num_worlds * num_havs, *values.shape[1:-1]
        # contiguous: NumPy's order of summation, and so the last bit, depends on the layout
        return np.ascontiguousarray(np.moveaxis(values, -1, 0)).reshape(shape)

    def every_hav(values: np.ndarray) -> np.ndarray:
        """(W,) -> (W * N,)."""
        return np.repeat(values, num_havs)

    num_trailers, length = rows(worlds.fleet.num_trailers), rows(worlds.fleet.length)
    present = np.arange(1, length.shape[1]) <= num_trailers[:, None]
    length[:, 1:][~present] = 0.0
    first, total = rows(worlds.record.first), rows(worlds.record.total)
    columns = {
        "episode": every_hav(worlds.state.clock[EPISODE]),
        "hav": np.tile(np.arange(num_havs), num_worlds),
        "num_trailers": num_trailers,
        "truck_length": length[:, 0],
        "trailer_lengths": _ragged(length[:, 1:], num_trailers),
        "vehicle_length": length.sum(axis=1),
        "footprint_radius": rows(worlds.fleet.radius)[:, FOOTPRINT],
        "stable_radius": rows(worlds.fleet.radius)[:, STABLE],
        **_pose_columns("start", rows(start)),
        **_jackknife_columns(first[:, JACKKNIFE], length, present),
        **_collision_columns("potential_collision", first[:, POTENTIAL]),
        **_collision_columns("actual_collision", first[:, ACTUAL]),
        "steps": every_hav(worlds.state.clock[STEP]),
        "moving_steps": total[:, MOVED].astype(np.int64),
        "path_length": total[:, PATH],
        "largest_articulation": total[:, LARGEST],
        "folded_through": total[:, LARGEST] > np.pi,
    }
    poses, goal, miss = rows(worlds.goals), rows(worlds.record.goal), rows(worlds.record.miss)
    path = np.zeros(len(goal))
    for g in range(poses.shape[1]):
        columns |= _pose_columns(f"goal_{g + 1}", poses[:, g])
        columns |= _goal_columns(f"goal_{g + 1}", goal[:, g], path)
        path = goal[:, g, HIT_PATH]
        for kind, word in ((HEADING_MISS, "heading"), (EUCLIDEAN_MISS, "euclidean")):
            name = f"goal_{g + 1}_{word}_miss"
            columns |= _miss_columns(name, miss[:, g, kind], present, policy)
    return pa.table(columns)


def _ragged(values: np.ndarray, counts: np.ndarray) -> pa.ListArray:
    """Return lists of the first ``counts`` values of each row."""
    offsets = np.concatenate([[0], np.cumsum(counts)])
    kept = np.arange(values.shape[1]) < counts[:, None]
    return pa.ListArray.from_arrays(pa.array(offsets, pa.int32()), pa.array(values[kept]))


def _pose_columns(name: str, poses: np.ndarray) -> dict:
    return {f"{name}_{part}": poses[:, k] for k, part in enumerate(("x", "y", "heading"))}


def _jackknife_columns(first: np.ndarray, length: np.ndarray, present: np.ndarray) -> dict:
    """First jackknife, and the paper's two metrics (section V).

    Joint Position Metric: where along the HAV the joint is, from 0 at the front axle to 1 at the
    last axle. Length Difference Metric: |l^j - l^{j-1}| over the vehicle length, at the joint that
    jackknifed and summed over all joints.
    """
    never = first[:, WHEN] == NEVER
    joint = np.where(never, 1, first[:, WHERE])
    each = np.arange(len(joint))
    whole = length.sum(axis=1)
    ahead = np.cumsum(length, axis=1)[each, joint - 1]
    differences = np.where(present, np.abs(np.diff(length, axis=1)), 0.0)
    return {
        "jackknifed": ~never,
        "jackknife_step": pa.array(first[:, WHEN], mask=never),
        "jackknife_joint": pa.array(joint, mask=never),
        "joint_position": pa.array(ahead / whole, mask=never),
        "joint_length_difference": pa.array(differences[each, joint - 1] / whole, mask=never),
        "length_difference": differences.sum(axis=1) / whole,
    }


def _collision_columns(name: str, first: np.ndarray) -> dict:
    never = first[:, WHEN] == NEVER
    return {
        name: ~never,
        f"{name}_step": pa.array(first[:, WHEN], mask=never),
        f"{name}_partner": pa.array(first[:, WHERE], mask=never),
    }


def _goal_columns(name: str, goal: np.ndarray, path_before: np.ndarray) -> dict:
    """The approach to one goal; ``path_before`` [m] was driven when it was assigned."""
    hit = goal[:, HIT_STEP] != NEVER
    never_assigned = np.isnan(goal[:, DUBINS])
    driven = goal[:, HIT_PATH] - path_before
    return {
        f"{name}_hit": hit,
        f"{name}_step": pa.array(goal[:, HIT_STEP].astype(np.int64), mask=~hit),
        f"{name}_distance": pa.array(goal[:, HIT_DISTANCE], mask=~hit),
        f"{name}_heading_difference": pa.array(goal[:, HIT_HEADING], mask=~hit),
        f"{name}_closest": pa.array(goal[:, CLOSEST], mask=never_assigned),
        f"{name}_dubins_length": pa.array(goal[:, DUBINS], mask=never_assigned),
        f"{name}_driven_length": pa.array(driven, mask=~hit),
        f"{name}_length_ratio": pa.array(driven / goal[:, DUBINS], mask=~hit),
    }


def _miss_columns(name: str, miss: np.ndarray, present: np.ndarray, policy) -> dict:
    """The narrowest close miss of one kind."""
    count = miss[:, MISS_COUNT].astype(np.int64)
    weights = joint_weights(policy, np.cos(miss[:, MISS_ARTICULATION:]))
    return {
        f"{name}_steps": count,
        f"{name}_distance": pa.array(miss[:, MISS_DISTANCE], mask=count == 0),
        f"{name}_heading_difference": pa.array(miss[:, MISS_HEADING], mask=count == 0),
        f"{name}_jackknife_weight": pa.array(
            np.where(present, weights, 0.0).sum(axis=1), mask=count == 0
        ),
    }
