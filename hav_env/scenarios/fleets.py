"""This module draws random fleets as in section V of the paper: units, lengths, limits."""

import math
from typing import NamedTuple

from hav_env.compiled import generic, kernel
from hav_env.maths.random_numbers import normal, uniform
from hav_env.models.checks import check_relations, require
from hav_env.models.quantities import (
    Articulation,
    Length,
    Offset,
    Share,
    Speed,
    Spread,
    Steering,
    Trailers,
)
from hav_env.scenarios.catalogue_fleet import CatalogueFleet, draw_catalogue_fleet
from hav_env.world.arrays import EPISODE, SEED, derive_radii, set_limits

_STREAM = 0  # of the episode's random numbers; policies use others
_MOST_DRAWS = 10_000  # of one length or count, before the draw fails as unreachable


class RandomFleet(NamedTuple):
    """The distributions of the HAVs of an episode; the defaults are the paper's."""

    min_trailers: Trailers = 1
    """Least number of trailers."""
    max_trailers: Trailers = 10
    """Largest number of trailers."""
    trailer_sigma: Spread = 3.0
    """sigma of the Rayleigh distribution of the trailer count."""
    trailer_offset: Offset = 0.0
    """Offset of a Rayleigh sample before truncation to a whole number: 0 truncates, 0.5 rounds. The
    paper leaves this open; truncation gives somewhat more goals."""
    trailer_redraw: bool = False
    """Whether to draw counts outside the limits again, instead of clipping them to the limits.
    The paper leaves this open; it matters for one HAV in twenty."""
    min_length: Length = 2.0
    """Least length of trucks and trailers [m]."""
    max_length: Length = 12.0
    """No length reaches this [m]."""
    short_truck_mean: Length = 4.0
    """Mean length of short trucks [m]. Half of the trucks are short, half are long; both lengths
    have normal distributions, drawn again when outside the limits."""
    short_truck_deviation: Spread = 0.6
    """Standard deviation of the length of short trucks [m]."""
    long_truck_mean: Length = 10.7
    """Mean length of long trucks [m]."""
    long_truck_deviation: Spread = 1.2
    """Standard deviation of the length of long trucks [m]."""
    footprint_truck_share: Share = 0.0
    """Share of the truck's length in the footprint radius d_i. The paper's formula sums the
    trailers alone, so a truck sticks out. Its few actual collisions suggest that trucks counted."""
    speed_max: Speed = 1.0
    """Largest speed [m/s]; equation (16) of the paper allows its fleets at least 1 m/s."""
    steering_max: Steering = math.radians(40.0)
    """Largest steering angle [rad]; the paper does not state it. v_max >= 1 m/s bounds it below
    58.8 degrees; 40 degrees fits the jackknifes and goals published for single HAVs
    (docs/reproduction.md)."""
    articulation_max: Articulation = math.pi / 2
    """Articulation above which a HAV is jackknifed [rad]."""


@kernel
def scenario_key(world, lane):
    """Return the key of a scenario's random numbers, from seed, episode and stream."""
    clock = world.state.clock
    return clock[SEED, lane], clock[EPISODE, lane], _STREAM


@generic
def draw_fleet(model, fleet, lane, key, draw):
    """Draw the HAVs of one lane.

    Args:
        model: their distributions; its type selects the kernel.
        fleet: the arrays to fill.
        lane: number of the world in the block.
        key: key of the episode's random numbers, see ``scenario_key``.
        draw: number of the first random number.

    Returns:
        The number of the next random number.
    """


@draw_fleet.register(RandomFleet)
def _draw_random_fleet(random_fleet, fleet, lane, key, draw):
    for agent in range(fleet.num_trailers.shape[0]):
        count, draw = _draw_count(random_fleet, key, draw)
        truck, draw = _draw_truck(random_fleet, key, draw)
        fleet.num_trailers[agent, lane] = count
        fleet.length[agent, :, lane] = math.inf
        fleet.length[agent, 0, lane] = truck
        for unit in range(1, count + 1):
            span = random_fleet.max_length - random_fleet.min_length
            fleet.length[agent, unit, lane] = random_fleet.min_length + span * uniform(*key, draw)
            draw += 1
        set_limits(random_fleet, fleet, agent, lane)
        derive_radii(fleet, agent, lane, random_fleet.footprint_truck_share)
    return draw


@kernel
def _draw_count(random_fleet, key, draw):
    for _ in range(_MOST_DRAWS):
        spread = math.sqrt(-2.0 * math.log(1.0 - uniform(*key, draw)))
        draw += 1
        count = math.floor(random_fleet.trailer_sigma * spread + random_fleet.trailer_offset)
        if not random_fleet.trailer_redraw:
            return min(max(count, random_fleet.min_trailers), random_fleet.max_trailers), draw
        if random_fleet.min_trailers <= count <= random_fleet.max_trailers:
            return count, draw
    return random_fleet.min_trailers, draw


@kernel
def _draw_truck(random_fleet, key, draw):
    for _ in range(_MOST_DRAWS):
        short = uniform(*key, draw) < 0.5
        mean = random_fleet.short_truck_mean if short else random_fleet.long_truck_mean
        spread = random_fleet.short_truck_deviation if short else random_fleet.long_truck_deviation
        length = mean + spread * normal(*key, draw + 1)
        draw += 3
        if random_fleet.min_length <= length < random_fleet.max_length:
            return length, draw
    return random_fleet.min_length, draw


draw_fleet.register(CatalogueFleet)(draw_catalogue_fleet)
Fleets = RandomFleet | CatalogueFleet


@check_relations.register
def _(fleet: RandomFleet) -> None:
    def demand(allowed: bool, field: str, rule: str) -> None:
        require(allowed, "fleet", fleet, field, rule)

    demand(fleet.max_trailers >= fleet.min_trailers, "max_trailers", "at least min_trailers")
    demand(fleet.max_length > fleet.min_length, "max_length", "above min_length")
    low, high = fleet.min_length - 1.0, fleet.max_length + 1.0
    for field in ("short_truck_mean", "long_truck_mean"):
        # a mean farther out would leave hardly a sample inside the limits
        demand(low <= getattr(fleet, field) <= high, field, f"in [{low}, {high}] m")
