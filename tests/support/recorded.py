"""This module has a recorded episode made by hand, so that nothing needs to be compiled."""

import numpy as np

from baselines.replay.trajectory import Trajectory
from hav_env.maths.kdop import SIDES
from hav_env.world.arrays import NEVER, OBSTACLE
from hav_env.world.event_table import EVENTS

WALLS = np.array([[30.0, -10.0, 30.0, 10.0], [0.0, 14.0, 50.0, 14.0], [5e4, 0.0, 5e4, 9.0]])
HIT = 50  # step in which the first truck drives into the first wall


def driven_into_wall() -> Trajectory:
    """Return an episode of two HAVs that drive ahead at 2 m/s, the first into a wall."""
    rows, havs, units = 101, 2, 2
    step = np.arange(rows)
    same = np.zeros((rows, havs))
    first = np.full((havs, len(EVENTS), 2), NEVER)
    first[0, OBSTACLE] = HIT, 0
    return Trajectory(
        step=step,
        x=same + 6.0 + 0.4 * step[:, None],
        y=same + np.array([0.0, 40.0]),
        heading=np.zeros((rows, havs, units)),
        waiting=same > 0,
        removed=same > 0,
        phase=same.astype(np.int64),
        speed=same + 2.0,
        steering=same,
        motion=np.stack([same + 2.0, same], axis=-1),
        evaded=np.full((rows, havs), NEVER),
        reserved=np.full((rows, havs), NEVER),
        outline=np.zeros((0, SIDES, 2)),
        num_trailers=np.ones(havs, np.int64),
        length=np.full((havs, units), 4.0),
        offset=np.zeros((havs, units)),
        shape=np.broadcast_to([1.2, 0.0, 0.5], (havs, units, 3)).copy(),
        footprint=np.full(havs, 8.0),
        articulation_max=np.full((havs, units), np.pi / 2),
        goals=np.array([[[70.0, 0.0, 0.0]], [[70.0, 40.0, 0.0]]]),
        segment=WALLS.copy(),
        first=first,
        hit_step=np.full((havs, 1), NEVER),
        dt=0.2,
        max_steps=rows - 1,
        policy="nobody",
        scenario="walls",
        seed=0,
        episode=0,
    )


def arrives_in_reserved_area() -> Trajectory:
    """Return the same episode in which HAV 1 has reserved an area, and arrives in step 80."""
    walls = driven_into_wall()
    angles = np.linspace(0.0, 2.0 * np.pi, SIDES, endpoint=False)
    corners = np.array([30.0, 40.0]) + np.stack([45 * np.cos(angles), 12 * np.sin(angles)], -1)
    reserved, hits, waiting = walls.reserved.copy(), walls.hit_step.copy(), walls.waiting.copy()
    reserved[:80, 1], hits[1, 0], waiting[80:, 1] = 0, 80, True
    return walls._replace(outline=corners[None], reserved=reserved, hit_step=hits, waiting=waiting)
