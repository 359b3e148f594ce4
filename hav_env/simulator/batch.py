"""This module has a batch of worlds that share a scenario: it owns the arrays, resets and steps."""

import functools
from typing import Any

import numpy as np

from hav_env.compiled import ZEROS, canonical, crew_of, default_threads, entry, lanes_from
from hav_env.maths.random_numbers import SEED_LIMIT, Seed
from hav_env.models.annotations import show
from hav_env.models.checks import check_value
from hav_env.models.memory import check_memory
from hav_env.models.protocols import Scenario, Vehicle
from hav_env.models.quantities import Precision, Threads, Worlds
from hav_env.scenarios import PlacementError, check_scenario, segments_of
from hav_env.simulator.beginning import begin
from hav_env.simulator.guiding import GUIDANCES, Guidance, check_guidance, guide
from hav_env.simulator.single_precision import check_drawn, check_single
from hav_env.simulator.transition import ended, remove_arrived, step
from hav_env.simulator.trial import try_scenario, try_vehicle
from hav_env.vehicles import OnAxle, bodies_of, check_vehicle, is_instant, needs_hitches
from hav_env.world.arrays import EPISODE, SEED, World, allocate_worlds, world_size
from hav_env.world.lanes import LANES, block_of, view_of
from hav_env.world.place.guidance import Dubins, of_each_world
from hav_env.world.task import Task, check_at_once, check_task
from hav_env.world.units.parts import Lines

_MOST_SHOWN = 600  # longest text of a scenario in an error message [characters]
_FEWEST = 4_096  # HAVs whose step takes longer than waking a thread


@entry
def begin_worlds(first, last, scenario, task, worlds, placed):
    """Start the episodes whose keys the clock of a range of worlds holds, block by block.

    ``placed`` becomes true where the scenario placed the HAVs.
    """
    for start in range(first, last, LANES):
        block = block_of(worlds, start, min(LANES, last - start), worlds.units)
        begin(scenario, task, block, placed[start:])


@entry
def step_worlds(first, last, task, vehicle, worlds, speed, steering):
    """Advance a range of worlds by one step, block by block."""
    for start in range(first, last, LANES):
        block = block_of(worlds, start, min(LANES, last - start), worlds.units)
        remove_arrived(task, block)
        step(task, vehicle, block, lanes_from(speed, start), lanes_from(steering, start))


class Batch:
    """W worlds of one scenario, stepped together; a single environment is a batch of one.

    Attributes:
        worlds: Arrays of the worlds, see ``hav_env.world.arrays``; the world is their last axis.
        scenario: Fleets, start poses and goal poses of the worlds.
        task: Rules of the episodes.
        vehicle: Vehicle model (kinematics).
        guidance: Guidance (routes to the goals).
        bytes_per_world: Memory that each world takes.
    """

    def __init__(
        self,
        scenario: Scenario,
        num_worlds: int = 1,
        task: Task = Task(),  # a NamedTuple is immutable
        vehicle: Vehicle = OnAxle(),
        threads: int | None = None,
        guidance: Guidance | str = Dubins(),
        precision: Precision = "double",
    ) -> None:
        """Allocate the worlds; they are empty until ``reset``.

        Args:
            scenario: Fleets, start poses and goal poses of the worlds.
            num_worlds: Number of worlds W.
            task: Rules of the episodes.
            vehicle: Vehicle model (kinematics).
            threads: Number of threads; by default ``HAV_THREADS`` or all cores.
            guidance: Guidance (routes to the goals): a model or its name.
            precision: Precision of the state. In "single", only a ``DecisionProcess`` begins
                episodes: it places HAVs in double precision.

        Raises:
            ValueError: If an argument is invalid, or the worlds need more memory than the machine
                has.
            TypeError: If an argument has another type, or the type of the scenario is not
                registered.
        """
        check_value("num_worlds", Worlds, num_worlds)
        check_value("threads", Threads | None, threads)
        check_value("precision", Precision, precision)
        check_scenario(scenario)
        check_task(task)
        check_vehicle(vehicle)
        check_parts(scenario, task, vehicle)
        try_scenario(scenario)
        try_vehicle(vehicle)
        self.scenario, self.task, self.vehicle = map(canonical, (scenario, task, vehicle))
        self.num_worlds = int(num_worlds)
        self.threads = threads
        self._begun = False
        self._step: Any = None  # compiled at the first step
        self.guidance = GUIDANCES.make(guidance)
        check_guidance(self.guidance, self.scenario, self.vehicle)
        if precision == "single":
            check_single(self.scenario, task, self.guidance)
        part = guide(self.guidance, self.scenario, self.vehicle, self.task)
        self.bytes_per_world = world_size(
            *_shape(self.scenario, self.task, self.vehicle, of_each_world(part))
        )
        check_memory("num_havs", self.scenario.num_havs, self.bytes_per_world)
        check_memory("num_worlds", self.num_worlds, self.bytes_per_world * self.num_worlds)
        self.worlds: World = worlds_for(self, self.num_worlds, part, precision)
        self._is_near = precision == "double"  # as near to the origin as the precision demands

    def __getstate__(self) -> dict[str, Any]:
        """Leave out the compiled step: a copy loads it again."""
        return self.__dict__ | {"_step": None}

    def reset(self, seed: int, episodes: np.ndarray | None = None) -> None:
        """Begin an episode in every world.

        Args:
            seed: Seed from 0 to 2**32 - 1. An episode is determined by scenario, seed and number.
            episodes: (W,) numbers of the episodes; by default 0 .. W - 1.

        Raises:
            ValueError: If the seed or an episode is out of range, or there is not one episode for
                each world.
            PlacementError: If a world has no space for its HAVs; the batch is then empty again.
            RuntimeError: If the worlds are in single precision.
        """
        self._begun = False
        if self.worlds.state.x.dtype != np.float64:
            raise RuntimeError('reset needs precision="double": other worlds begin in environments')
        check_seed(seed)
        if episodes is None:
            episodes = np.arange(self.num_worlds)
        episodes = read_episodes(episodes)
        if episodes.shape != (self.num_worlds,):
            raise ValueError(
                f"episodes has shape {episodes.shape}, not (W,) = ({self.num_worlds},)"
            )
        clock, placed = self.worlds.state.clock, np.zeros(self.num_worlds, np.bool_)
        clock[SEED], clock[EPISODE] = seed, episodes
        models = self.scenario, self.task
        begin_worlds(self.num_worlds, *models, self.worlds, placed, threads=self.num_threads)
        check_placed(placed, self.scenario)
        self._begun = True

    def step(self, speed: np.ndarray, steering: np.ndarray) -> None:
        """Advance every world by one step; worlds that have ended continue too.

        Args:
            speed: (N, W) speeds of the trucks [m/s], clipped to the limits of each HAV.
            steering: (N, W) steering angles [rad], left positive, clipped likewise.

        Raises:
            ValueError: If a shape is wrong, a number is not finite, or HAVs decide in turn.
            RuntimeError: If ``reset`` has not been called.
        """
        if not self._begun:
            raise RuntimeError("call reset before step: the worlds are empty")
        check_at_once(self.task)
        shape = self.worlds.state.x.shape
        arrays = []
        for name, values in (("speed", speed), ("steering", steering)):
            array = np.asarray(values, float)
            if array.shape != shape:
                raise ValueError(f"{name} has shape {array.shape}, but must have (N, W) = {shape}")
            if not np.isfinite(array).all():
                raise ValueError(f"{name} holds a number that is not finite")
            arrays.append(np.ascontiguousarray(array))
        args = self.task, self.vehicle, self.worlds, *arrays
        if self._step is None:
            self._step = step_worlds.prepare(*args)
        self._step(crew_of(self.num_threads), self.num_worlds, args)

    def check_places(self, places: np.ndarray, placed: np.ndarray) -> None:
        """Check once that the scenario puts HAVs and goals where the precision suffices.

        Args:
            places: Indices of the worlds whose episodes have just begun.
            placed: (len(places),) bool, cleared before an error.

        Raises:
            ValueError: If a start or a goal is too far from the origin.
        """
        if not self._is_near:
            check_drawn(self.worlds, places, placed)
            self._is_near = True  # the first episode of a scenario stands for all

    @property
    def num_threads(self) -> int:
        """Return the number of threads that pay for this batch."""
        most = max(1, self.worlds.state.x.size // _FEWEST)
        return min(self.threads or default_threads(), most)

    def world(self, w: int) -> World:
        """Return the view of one world: the arrays without their last axis."""
        return view_of(self.worlds, w)

    @property
    def ended(self) -> np.ndarray:
        """Return whether episodes are over, (W,) bool: last goals hit, an ending event, or time."""
        return ended(self.task, self.worlds, slice(None))


def worlds_for(
    batch: Batch, num_worlds: int, guidance: Any = None, precision: Precision = "double"
) -> World:
    """Return new arrays of worlds in which episodes of a batch may begin.

    Args:
        batch: Batch whose models the worlds have.
        num_worlds: Number of worlds.
        guidance: Guidance of the worlds, by default the batch's.
        precision: Precision of the state.
    """
    part = batch.worlds.guidance if guidance is None else guidance
    shape = _shape(batch.scenario, batch.task, batch.vehicle, part)
    return functools.partial(allocate_worlds, zeros=ZEROS[precision])(num_worlds, *shape)


def _shape(scenario: Any, task: Task, vehicle: Any, guidance: Any) -> tuple:
    units = scenario.max_trailers + 1
    parts = not is_instant(vehicle), needs_hitches(vehicle), bodies_of(vehicle)
    shape = scenario.num_havs, units, scenario.num_goals, task.continuous_collisions
    return *shape, *parts, segments_of(scenario), guidance


def check_parts(scenario: Scenario, task: Task, vehicle: Vehicle) -> None:
    """Check that a vehicle supports the fleet and the rules of an episode.

    Raises:
        ValueError: If the vehicle does not support the hitches of the fleet, or the rules ask for
            collisions between steps and the vehicle does not support them.
    """
    hitched = needs_hitches(vehicle)
    if not hitched and np.any(getattr(scenario.fleet, "offset", 0.0)):
        raise ValueError(
            f"vehicle is {type(vehicle).__name__}, but must support hitches off the axles, which"
            " this scenario has: add --vehicle realistic, in Python vehicle='realistic'"
        )
    known = not hitched and isinstance(bodies_of(vehicle), Lines)
    if task.continuous_collisions and not known:
        raise ValueError(
            "task continuous_collisions is True, but must be False for vehicles with hitches off"
            " the axles or with bodies that have a width: they are compared at steps alone"
        )


def check_seed(seed: Any) -> None:
    """Raise ValueError or TypeError unless the seed is a whole number of 32 bits."""
    check_value("seed", Seed, seed)


def read_episodes(episodes: Any) -> np.ndarray:
    """Return the numbers of episodes as int64.

    Raises:
        ValueError: If one is out of range; TypeError: if they are not whole numbers.
    """
    try:
        array = np.asarray(episodes)
    except ValueError:  # lists of unequal lengths
        array = np.array(None)
    if array.dtype.kind not in "iu" and array.size > 0:
        rule = f"must be whole numbers from 0 to {SEED_LIMIT - 1}"
        raise TypeError(f"episodes is {show(episodes)}, but {rule}")
    if array.size > 0 and (array.min() < 0 or array.max() >= SEED_LIMIT):
        worst = array[(array < 0) | (array >= SEED_LIMIT)].flat[0]
        raise ValueError(f"episodes holds {worst}, but must be from 0 to {SEED_LIMIT - 1}")
    return np.ascontiguousarray(array, np.int64)


def check_placed(placed: np.ndarray, scenario: Scenario) -> None:
    """Raise PlacementError if the scenario could not place the HAVs of a world."""
    missing = placed.size - np.count_nonzero(placed)
    if missing > 0:
        text = " ".join(repr(scenario).split())[:_MOST_SHOWN]
        clear = "potential collisions" if segments_of(scenario) == 0 else "collisions"
        raise PlacementError(
            f"{missing} of {placed.size} worlds have no space for"
            f" {scenario.num_havs} HAVs without {clear}: {text}"
        )
