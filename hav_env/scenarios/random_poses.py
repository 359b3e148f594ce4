"""The paper's scenario, section V: random fleets, random start poses, random goal poses."""

import math
from typing import NamedTuple

from hav_env.collision import collision_distance
from hav_env.compiled import kernel
from hav_env.randomness import normal, uniform
from hav_env.world import EPISODE, FOOTPRINT, SEED, derive_radii, put_straight, set_limits

_STREAM = 0  # of the episode's random numbers; policies use others
_MOST_DRAWS = 10_000  # of one length or count, before the limits are held to be unreachable


class RandomPoses(NamedTuple):
    """Random HAVs at random poses, in a square four times as large as their footprints."""

    num_havs: int = 1
    """M, how many HAVs share the plane; the paper's are 1 and 2."""
    num_goals: int = 2
    """How many goals each HAV gets, one after the other."""
    min_trailers: int = 1
    max_trailers: int = 10
    trailer_sigma: float = 3.0
    """sigma of the Rayleigh distribution of the trailer count."""
    trailer_offset: float = 0.0
    """Added before a Rayleigh sample is cut to a whole number: 0 cuts downwards, 0.5 rounds.
    The paper leaves this open; cutting gives somewhat more goals."""
    trailer_redraw: bool = False
    """Draw counts outside the limits again, instead of moving them to the nearest limit.
    The paper leaves this open; it matters for one HAV in twenty."""
    min_length: float = 2.0
    """Least length of trucks and trailers [m]."""
    max_length: float = 12.0
    """No length reaches this [m]."""
    short_truck_mean: float = 4.0
    """Truck lengths are an even mixture of two normal distributions [m], drawn again when outside
    the limits."""
    short_truck_deviation: float = 0.6
    long_truck_mean: float = 10.7
    long_truck_deviation: float = 1.2
    area_factor: float = 4.0
    """Area of the square over the sum of the footprints' areas; 2 is double density."""
    footprint_truck_share: float = 0.0
    """Share of the truck's length in the footprint radius d_i. The paper's formula sums the
    trailers alone, so that a truck sticks out; its few actual collisions read as if trucks
    counted."""
    speed_max: float = 1.0
    """[m/s]; eq. (vmax) allows the paper's fleets at least this."""
    steering_max: float = math.radians(40.0)
    """[rad]; the paper does not state it. v_max >= 1 m/s bounds it below 58.8 degrees; 40 degrees
    fits the jackknifes and goals published for single HAVs (docs/reproduction.md)."""
    articulation_max: float = math.pi / 2
    """Jackknifed beyond it [rad]."""
    pose_attempts: int = 1_000
    """Poses tried for one HAV before the world is drawn afresh."""
    world_attempts: int = 50
    """Worlds drawn before the density is held to be unreachable."""


def populate_random_poses(scenario, world, lane):
    """Draw one world; worlds that leave no room for a pose are drawn afresh, a bounded number."""
    clock = world.state.clock
    key = clock[SEED, lane], clock[EPISODE, lane], _STREAM
    draw = 0
    for _ in range(scenario.world_attempts):
        draw = _draw_fleet(scenario, world.fleet, lane, key, draw)
        side = _area_side(scenario, world.fleet, lane)
        # phase -1 stands for the starts, drawn where the first goals will be
        for phase in range(-1, scenario.num_goals):
            draw = _place_all(scenario, world, max(phase, 0), side, lane, key, draw)
            if draw < 0:
                break
            if phase < 0:
                for agent in range(scenario.num_havs):
                    x, y, heading = world.goals[agent, 0, :, lane]
                    put_straight(world.state, agent, lane, x, y, heading)
        if draw >= 0:
            return True
        draw = -draw
    return False


@kernel
def _draw_fleet(scenario, fleet, lane, key, draw):
    for agent in range(fleet.num_trailers.shape[0]):
        count, draw = _draw_count(scenario, key, draw)
        truck, draw = _draw_truck(scenario, key, draw)
        fleet.num_trailers[agent, lane] = count
        fleet.length[agent, :, lane] = math.inf
        fleet.length[agent, 0, lane] = truck
        for unit in range(1, count + 1):
            span = scenario.max_length - scenario.min_length
            fleet.length[agent, unit, lane] = scenario.min_length + span * uniform(*key, draw)
            draw += 1
        set_limits(scenario, fleet, agent, lane)
        derive_radii(fleet, agent, lane, scenario.footprint_truck_share)
    return draw


@kernel
def _draw_count(scenario, key, draw):
    for _ in range(_MOST_DRAWS):
        rayleigh = scenario.trailer_sigma * math.sqrt(-2.0 * math.log(1.0 - uniform(*key, draw)))
        draw += 1
        count = math.floor(rayleigh + scenario.trailer_offset)
        if not scenario.trailer_redraw:
            return min(max(count, scenario.min_trailers), scenario.max_trailers), draw
        if scenario.min_trailers <= count <= scenario.max_trailers:
            return count, draw
    return scenario.min_trailers, draw


@kernel
def _draw_truck(scenario, key, draw):
    for _ in range(_MOST_DRAWS):
        short = uniform(*key, draw) < 0.5
        mean = scenario.short_truck_mean if short else scenario.long_truck_mean
        deviation = scenario.short_truck_deviation if short else scenario.long_truck_deviation
        length = mean + deviation * normal(*key, draw + 1)
        draw += 3
        if scenario.min_length <= length < scenario.max_length:
            return length, draw
    return scenario.min_length, draw


@kernel
def _area_side(scenario, fleet, lane):
    """Return A [m]: A^2 = 4 sum_i pi d_i^2 for the paper's area factor."""
    footprints = 0.0
    for agent in range(fleet.radius.shape[0]):
        radius = fleet.radius[agent, FOOTPRINT, lane]
        footprints += math.pi * radius * radius
    return math.sqrt(scenario.area_factor * footprints)


@kernel
def _place_all(scenario, world, phase, side, lane, key, draw):
    """Draw the goals of a phase, none in potential collision with another; return the next draw.

    The draw comes back negative when there was no room.
    """
    goals = world.goals
    for agent in range(scenario.num_havs):
        free = False
        for _ in range(scenario.pose_attempts):
            goals[agent, phase, 0, lane] = side * uniform(*key, draw)
            goals[agent, phase, 1, lane] = side * uniform(*key, draw + 1)
            goals[agent, phase, 2, lane] = 2.0 * math.pi * uniform(*key, draw + 2)
            draw += 3
            free = _is_free(world, phase, agent, lane)
            if free:
                break
        if not free:
            return -draw
    return draw


@kernel
def _is_free(world, phase, agent, lane):
    goals = world.goals
    for other in range(agent):
        dx = goals[agent, phase, 0, lane] - goals[other, phase, 0, lane]
        dy = goals[agent, phase, 1, lane] - goals[other, phase, 1, lane]
        if math.sqrt(dx * dx + dy * dy) <= collision_distance(world.fleet, agent, other, lane):
            return False
    return True


def check_random_poses(scenario: RandomPoses) -> None:
    """Check the parameters; raises ValueError with field, value and what is allowed."""

    def require(allowed: bool, field: str, rule: str) -> None:
        if not allowed:
            raise ValueError(f"scenario {field} is {getattr(scenario, field)}, but must be {rule}")

    for field, value in scenario._asdict().items():
        require(math.isfinite(value), field, "finite")
    for field in ("num_havs", "num_goals", "pose_attempts", "world_attempts", "min_trailers"):
        require(getattr(scenario, field) >= 1, field, "at least 1")
    require(scenario.max_trailers >= scenario.min_trailers, "max_trailers", "at least min_trailers")
    require(scenario.min_length > 0, "min_length", "above 0 m")
    require(scenario.max_length > scenario.min_length, "max_length", "above min_length")
    low, high = scenario.min_length - 1.0, scenario.max_length + 1.0
    for field in ("short_truck_mean", "long_truck_mean"):
        # a mean farther out would leave hardly a sample inside the limits
        require(low <= getattr(scenario, field) <= high, field, f"in [{low}, {high}] m")
    for field in ("short_truck_deviation", "long_truck_deviation", "trailer_sigma"):
        require(getattr(scenario, field) > 0, field, "above 0")
    require(scenario.area_factor > 0, "area_factor", "above 0")
    require(0 <= scenario.footprint_truck_share <= 1, "footprint_truck_share", "in [0, 1]")
    require(scenario.speed_max > 0, "speed_max", "above 0 m/s")
    require(0 < scenario.steering_max < math.pi / 2, "steering_max", "in (0, pi/2) rad")
    require(0 < scenario.articulation_max <= math.pi, "articulation_max", "in (0, pi] rad")
