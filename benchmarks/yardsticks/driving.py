"""This module has two yardsticks: the compiled step of one HAV in plain Python and in NumPy.

Both drive one HAV with five trailers by AVOID-JACK from goal to goal. They select the goal's side
by the shortest of six Dubins words, sum jackknife weights, make one Euler step, and test for a
jackknife and for the goal. They compute what a typical program without a compiler would, and less
than hav_env, which also keeps records (close misses, largest articulation, driven path).
"""

from benchmarks.yardsticks.five_trailers import POLICY, SCENARIO, TASK, VEHICLE, Outcome
from benchmarks.yardsticks.plain_python import drive_plain_python
from benchmarks.yardsticks.small_arrays import drive_small_arrays
from hav_env import Batch
from hav_env.policies.interface import allocate_memory, decide
from hav_env.world.arrays import JACKKNIFE, PHASE, WHEN

__all__ = ["check", "drive_compiled", "drive_plain_python", "drive_small_arrays"]


def drive_compiled(num_steps: int, policy=POLICY, scenario=SCENARIO, vehicle=VEHICLE) -> Outcome:
    """Drive by hav_env, step by step from Python, up to more steps than the goals need."""
    batch = Batch(scenario, task=TASK, vehicle=vehicle)
    batch.reset(seed=0)
    memory = allocate_memory(policy, 1, 1)
    for _ in range(num_steps):
        batch.step(*decide(policy, memory, batch))
    state, first = batch.worlds.state, batch.worlds.record.first
    return Outcome(
        float(state.x[0, 0]),
        float(state.y[0, 0]),
        state.heading[0, :, 0].tolist(),
        int(state.goal[0, PHASE, 0] + state.waiting[0, 0]),
        int(first[0, JACKKNIFE, WHEN, 0]),
    )


def check(num_steps: int = 1_200, tolerance: float = 1e-9) -> None:
    """Check that both yardsticks reproduce hav_env.

    Args:
        num_steps: Number of steps; the default passes the first goal.
        tolerance: Tolerance of positions [m] and headings [rad], which differ by rounding.

    Raises:
        AssertionError: If a yardstick deviates; the message names it and the deviation.
    """
    compiled = drive_compiled(num_steps)
    for drive in (drive_plain_python, drive_small_arrays):
        outcome = drive(num_steps)
        numbers = zip(
            (outcome.x, outcome.y, *outcome.headings),
            (compiled.x, compiled.y, *compiled.headings),
            strict=True,
        )
        error = max(abs(own - other) for own, other in numbers)
        if not error <= tolerance or outcome[3:] != compiled[3:]:
            raise AssertionError(
                f"{drive.__name__} is off by {error} after {num_steps} steps:"
                f" {outcome} instead of {compiled}"
            )
