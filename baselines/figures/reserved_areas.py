"""This module computes the reserved areas of HAVs under Reserve, in coordinates of their world.

It uses their memory (``baselines.policies.reserve.memory.rows``) and the poses of their trucks,
because a HAV remembers everything in its truck's frame.
"""

import numpy as np

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import states
from baselines.policies.reserve.prediction.paths import heading_at
from hav_env import Batch, Task
from hav_env.maths.kdop import SIDES, corner
from hav_env.policies.driver import PolicyDriver

_STEP_ROUNDING = 1e-6  # share of a step: a path may be shorter by that than its number of steps


def remember(policy, scenario, seed: int, episode: int, task: Task = Task()) -> np.ndarray:
    """Run an episode as ``record_trajectory`` does, and return the memory of its HAVs.

    Returns:
        The memory (T, N, K) in each of the T states of the trajectory.
    """
    batch = Batch(scenario, 1, task)
    batch.reset(seed, np.array([episode]))
    driver = PolicyDriver(policy, batch)
    kept = [driver.memory[..., 0].copy()]
    while not batch.ended[0]:
        batch.step(*driver.decide())
        kept.append(driver.memory[..., 0].copy())
    return np.array(kept)


def reserved_corners(rows: np.ndarray, x: float, y: float, heading: float) -> np.ndarray | None:
    """Return the corners (24, 2) [m] of the outline that a HAV has reserved, None if it stands.

    Args:
        rows: The HAV's memory after a step.
        x: x of its truck at that time [m].
        y: y of its truck at that time [m].
        heading: Heading of its truck at that time [rad].
    """
    if rows[m.MODE] != states.RESERVED:
        return None
    corners = np.array([corner(rows, m.OUTLINE, side) for side in range(SIDES)])
    frame = rows[m.FRAME_AFTER : m.FRAME_AFTER + 4]
    return _from_frame(_from_frame(corners, *frame), x, y, np.cos(heading), np.sin(heading))


def path_ahead(rows: np.ndarray, x: float, y: float, heading: float, last: float) -> np.ndarray:
    """Return the poses (P, 3) of a HAV in its next steps, up to ``last`` [m] along its path."""
    first, step = rows[m.DRIVEN], rows[m.OWN_STEP]
    count = max(int((last - first) / step + _STEP_ROUNDING), 0)
    # a truck turns first and then moves, so its heading is that of the path half a step before
    middles = [first + (k - 0.5) * step for k in range(count + 1)]
    along = np.array([heading_at(rows, m.CURRENT_PATH, middle) for middle in middles])
    along += heading - along[0]
    steps = step * np.stack([np.cos(along), np.sin(along)], axis=-1)
    steps[0] = x, y
    return np.column_stack([steps.cumsum(axis=0), along])


def circle_behind(
    rows: np.ndarray, x: float, y: float, heading: float
) -> tuple[np.ndarray, float] | None:
    """Return centre (2,) and radius [m] of the endless circle that a HAV has reserved, or None.

    It is the circle of the truck's front axle, behind the end of the reserved part.
    """
    side, end, shift = rows[m.CIRCLE_SIDE], rows[m.PART_END], rows[m.CIRCLE_SHIFT]
    if rows[m.MODE] != states.RESERVED or side == 0.0:
        return None
    if rows[m.PURPOSE] == states.CIRCLE_PATH:  # the path is the circle
        end = rows[m.DRIVEN]
        turned = heading_at(rows, m.CURRENT_PATH, end)
        heading += turned - heading_at(rows, m.CURRENT_PATH, end - 0.5 * rows[m.OWN_STEP])
        shift = max(shift - end, 0.0)
    x, y, heading = path_ahead(rows, x, y, heading, end)[-1]
    seen = np.array([[shift, side * rows[m.OWN_REAR_RADIUS]]])
    centre = _from_frame(seen, x, y, np.cos(heading), np.sin(heading))[0]
    return centre, float(rows[m.OWN_FRONT_RADIUS])


def _from_frame(points: np.ndarray, x: float, y: float, cosine: float, sine: float) -> np.ndarray:
    """Return points (P, 2) of a frame in the coordinates in which the frame is given."""
    return np.array([x, y]) + points @ np.array([[cosine, sine], [-sine, cosine]])
