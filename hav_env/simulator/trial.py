"""This module tries a user's code once as plain Python, before Numba compiles it.

A misspelt name or a wrong result is then one line that names the user's file and line. Numba would
take seconds and print a page. The module tries each user class once, and no class of the project.
"""

import traceback
import warnings
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from hav_env.models.annotations import is_number
from hav_env.scenarios import RandomFleet, RandomPoses, populate, segments_of
from hav_env.simulator.beginning import begin
from hav_env.simulator.names_used import undefined_name
from hav_env.vehicles import OnAxle, bodies_of, move, needs_hitches
from hav_env.world.arrays import EPISODE, World, allocate_worlds
from hav_env.world.task import Task

LANES_TRIED, HAVS_TRIED = 2, 3
_OURS = {"hav_env", "baselines", "train"}
_EVERYBODY = 1e5  # [m], sensing range in which all HAVs sense each other
_tried: set[Any] = set()


def is_users_kernel(kernel: Callable) -> bool:
    """Return whether a kernel is the code of a user, and no part of the project."""
    return kernel.__module__.partition(".")[0] not in _OURS


def attempt(kind: str, model: Any, kernel: Callable, call: Callable[[], str]) -> None:
    """Call a user's kernel as plain Python, unless it has been tried.

    Args:
        kind: Kind of model, for the message.
        model: Model whose class selects the kernel.
        kernel: Kernel registered for that class.
        call: Function that calls the kernel, and returns the rule that its result broke, or "".

    Raises:
        ValueError: If the kernel raises or its result is wrong; the message names file and line.
    """
    if not is_users_kernel(kernel) or kernel in _tried:
        return
    message = f"{kind} {type(model).__name__}: {kernel.__name__}"
    undefined = undefined_name(kernel, kernel.__module__.partition(".")[0])
    if undefined is not None:
        raise ValueError(f"{message}: {undefined[0]} ({undefined[1]}, line {undefined[2]})")
    _tried.add(kernel)
    code = kernel.__code__
    line: int | None = code.co_firstlineno
    try:
        with np.errstate(all="ignore"), warnings.catch_warnings(action="ignore"):
            broken = call()
    except ZeroDivisionError:  # compiled code continues with infinity
        return
    except Exception as error:
        frames = traceback.extract_tb(error.__traceback__)
        lines = [frame.lineno for frame in frames if frame.filename == code.co_filename]
        line = lines[-1] if lines else line
        broken = f"raises {type(error).__name__}: {error}"
    if broken:
        _tried.discard(kernel)
        raise ValueError(f"{message} {broken} ({code.co_filename}, line {line})")


def try_scenario(scenario: Any) -> None:
    """Try the scenario's code in one world; see ``attempt``."""
    kernel = populate.table[type(scenario)]
    few = scenario
    if "num_havs" in scenario._fields and scenario.num_havs > HAVS_TRIED:
        few = scenario._replace(num_havs=HAVS_TRIED)

    def call() -> str:
        shape = few.num_havs, few.max_trailers + 1, few.num_goals
        worlds = allocate_worlds(1, *shape, num_segments=segments_of(few))
        placed = populate(few, worlds, 0)
        if not isinstance(placed, bool | np.bool_):
            return f"returns {placed!r}, but must return whether it placed the HAVs: True or False"
        return ""

    attempt("scenario", scenario, kernel, call)


def try_vehicle(vehicle: Any) -> None:
    """Try the vehicle's code in one step; see ``attempt``."""

    def call() -> str:
        worlds = sample_worlds(vehicle=vehicle)
        move(vehicle, 0.2, worlds, 0)
        state = worlds.state
        poses = state.x[0], state.y[0], *state.heading[0], *state.cosine[0], *state.sine[0]
        return "" if np.isfinite(poses).all() else "writes a pose that is not finite"

    attempt("vehicle", vehicle, move.table[type(vehicle)], call)


def sample_worlds(
    num_havs: int = HAVS_TRIED, num_goals: int = 2, max_trailers: int = 3, vehicle: Any = OnAxle()
) -> World:
    """Return ``LANES_TRIED`` worlds of random HAVs at the beginning, driving straight on."""
    fleet = RandomFleet(max_trailers=max_trailers)
    scenario = RandomPoses(num_havs=num_havs, num_goals=num_goals, fleet=fleet)
    parts = {"hitched": needs_hitches(vehicle), "bodies": bodies_of(vehicle)}
    worlds = allocate_worlds(LANES_TRIED, num_havs, max_trailers + 1, num_goals, **parts)
    worlds.state.clock[EPISODE] = np.arange(LANES_TRIED)
    begin(scenario, Task(sensing_range=_EVERYBODY), worlds, np.zeros(LANES_TRIED, np.bool_))
    worlds.state.speed[:] = 1.0
    return worlds


class _Neighbors(np.ndarray):
    """Indices of neighbours (W, N, N - 1), of which a user's code may read those that exist."""

    count: np.ndarray

    def __getitem__(self, key: Any) -> Any:
        """Return what the array holds.

        Raises:
            IndexError: If there is no such neighbour; compiled code would read any number.
        """
        if isinstance(key, tuple) and len(key) == self.ndim and all(map(is_number, key)):
            lane, agent, place = key
            number = self.count[agent, lane]
            if not 0 <= place < number:
                told = f"neighbour {place} of a HAV that has {number}"
                raise IndexError(f"{told}: k must be below sensing.num_neighbors(...)")
        return super().__getitem__(key)


def with_fewer_neighbors(worlds: World) -> Iterator[World]:
    """Yield worlds in which HAVs sense all neighbours, then one less, and so on until none."""
    nearby = worlds.nearby
    for most in range(worlds.state.x.shape[0] - 1, -1, -1):
        index = nearby.index.view(_Neighbors)
        index.count = np.minimum(nearby.count, most)
        yield worlds._replace(nearby=nearby._replace(index=index, count=index.count))
