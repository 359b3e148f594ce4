"""Random numbers of a HAV under Reserve: a stream of the episode for each HAV and purpose.

Streams do not overlap, whatever the number of HAVs. Within a stream every step has draws of its
own; they come again only when their number passes 2**32.
"""

from baselines.policies.reserve.memory import rows as m
from hav_env.compiled import kernel

PLANS, PLACES, NOISE = range(3)  # purposes: where to aim, by way of which places, what is sensed
_PURPOSES = 3


@kernel
def random_key(rows, purpose, draws):
    """Return what the random numbers of a purpose depend on in this step.

    Args:
        rows: the HAV's memory.
        purpose: PLANS .. NOISE.
        draws: how many the purpose takes in a step at most, the same in every step.

    Returns:
        Seed, episode, stream and the first draw of the step.
    """
    # stream 0 is the scenario's
    stream = _PURPOSES * int(rows[m.OWN_NUMBER]) + purpose + 1
    return (
        int(rows[m.OWN_RANDOM_KEY]),
        int(rows[m.OWN_RANDOM_KEY + 1]),
        stream,
        draws * int(rows[m.OWN_RANDOM_KEY + 2]),
    )
