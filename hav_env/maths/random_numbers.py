"""This module draws random numbers without a state: draw k is a function of (seed, episode, k).

The function is Threefry-2x32 with 20 rounds (Salmon et al., "Parallel random numbers: as easy as 1,
2, 3", SC11). An episode is therefore the same alone, in a batch, on any thread, compiled or not.
Draw k does not depend on earlier draws.
"""

import math
from typing import Annotated

from hav_env.compiled import kernel, rare_kernel
from hav_env.models.annotations import Range

_MASK = 0xFFFFFFFF
_PARITY = 0x1BD11BDA
SEED_LIMIT = 2**32  # seeds and episode numbers are words of 32 bits
Seed = Annotated[int, Range(0, SEED_LIMIT - 1, said=f"from 0 to {SEED_LIMIT - 1}")]


@kernel
def _mix(x0, x1, rotation):
    x0 = (x0 + x1) & _MASK
    x1 = ((x1 << rotation) | (x1 >> (32 - rotation))) & _MASK
    return x0, x0 ^ x1


@kernel
def threefry(key0, key1, counter0, counter1):
    """Return two words of 32 bits, a bijection of the two counters under the two keys."""
    key2 = _PARITY ^ key0 ^ key1
    x0, x1 = (counter0 + key0) & _MASK, (counter1 + key1) & _MASK
    even, odd = key1, key2  # the keys injected after each four rounds
    last = key0
    for injection in range(1, 6):
        if injection % 2 == 1:
            x0, x1 = _mix(x0, x1, 13)
            x0, x1 = _mix(x0, x1, 15)
            x0, x1 = _mix(x0, x1, 26)
            x0, x1 = _mix(x0, x1, 6)
        else:
            x0, x1 = _mix(x0, x1, 17)
            x0, x1 = _mix(x0, x1, 29)
            x0, x1 = _mix(x0, x1, 16)
            x0, x1 = _mix(x0, x1, 24)
        x0, x1 = (x0 + even) & _MASK, (x1 + odd + injection) & _MASK
        even, odd, last = odd, last, even
    return x0, x1


@rare_kernel
def uniform(seed, episode, stream, draw):
    """Return a number in [0, 1) with 53 random bits: draw number ``draw`` of one stream.

    Streams separate the random numbers of one episode by their use.
    """
    high, low = threefry(seed, episode, draw, stream)
    return ((high >> 5) * 67108864.0 + (low >> 6)) * (1.0 / 9007199254740992.0)


@kernel
def normal(seed, episode, stream, draw):
    """Return a standard normal number; uses draws ``draw`` and ``draw + 1`` (Box and Muller)."""
    radius = math.sqrt(-2.0 * math.log(1.0 - uniform(seed, episode, stream, draw)))
    return radius * math.cos(2.0 * math.pi * uniform(seed, episode, stream, draw + 1))
