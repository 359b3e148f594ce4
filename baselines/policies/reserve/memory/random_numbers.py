"""This module draws random numbers for a HAV under Reserve: a stream for each HAV and use.

Streams do not overlap, whatever the number of HAVs. Within a stream every step has draws of its
own. They repeat only when their number passes 2**32.
"""

from baselines.policies.reserve.memory import rows as m
from hav_env.compiled import kernel

# Uses of random numbers: the aim of a plan, the waypoints of candidates, the noise of sensing.
PLANS, PLACES, NOISE = range(3)
_NUM_USES = 3


@kernel
def random_key(rows, use, draws):
    """Return the key of the random numbers of one use in this step.

    Args:
        rows: The HAV's memory.
        use: PLANS, PLACES or NOISE.
        draws: Largest number of draws of this use in a step, the same in every step.

    Returns:
        Seed, episode, stream and the first draw of the step.
    """
    # stream 0 belongs to the scenario
    stream = _NUM_USES * int(rows[m.OWN_NUMBER]) + use + 1
    return (
        int(rows[m.OWN_RANDOM_KEY]),
        int(rows[m.OWN_RANDOM_KEY + 1]),
        stream,
        draws * int(rows[m.OWN_RANDOM_KEY + 2]),
    )
