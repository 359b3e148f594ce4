"""This module measures other multi-agent simulators on their own tasks: agent-steps per second.

``python -m benchmarks.interfaces.peers`` prints the table. The actions are random. The peers are
optional: ``pip install 'mpe2>=1.1' 'vmas>=1.5'`` brings them, and the table leaves out missing
ones. mpe2 before 1.1 needs ``pygame``, which conflicts with ``pygame-ce``. Their tasks differ from
this project's and from each other, so the figures show orders of magnitude only.
"""

import functools
import importlib.util
from collections.abc import Iterable
from typing import Any, NamedTuple

import tyro
from rich.console import Console

from benchmarks.interfaces.clocks import DRAWN, Run, clocked, prepare_parallel
from benchmarks.tables import new_table, rate_text
from benchmarks.turns import medians_in_turns

PACKAGES = ("mpe2", "vmas")
NUM_AGENTS = 2
_HORIZON = 100  # steps after which VMAS's worlds are reset, all at once
_NUM_ENVS = (1, 1_024, 16_384)
_THREADS = (1, 2)
_SCENARIOS = ("navigation", "simple_spread", "kinematic_bicycle")


class Peer(NamedTuple):
    """A task of another simulator, and its settings."""

    task: str
    num_envs: int = 1
    threads: int | None = None  # None: it has no threads

    def __str__(self) -> str:
        """Return the name of its row."""
        words = [self.task, "1 env" if self.num_envs == 1 else f"{self.num_envs:,} envs"]
        if self.threads is not None:
            words.append("1 thread" if self.threads == 1 else f"{self.threads} threads")
        return ", ".join(words)


MPE_SPREAD = "MPE2 simple_spread"
NAVIGATION, VMAS_SPREAD, BICYCLE = (f"VMAS {scenario}" for scenario in _SCENARIOS)


def missing_packages() -> list[str]:
    """Return the packages whose rows are left out."""
    return [name for name in PACKAGES if importlib.util.find_spec(name) is None]


def prepare_mpe() -> Run:
    """Return a loop over MPE's simple_spread, one environment, with resets."""
    from mpe2 import simple_spread_v3  # noqa: PLC0415  (optional)

    return prepare_parallel(simple_spread_v3.parallel_env(N=NUM_AGENTS))


def prepare_vmas(scenario: str, num_envs: int, threads: int) -> Run:
    """Return a loop over a VMAS scenario on the CPU, with resets; it warms up here."""
    import torch  # noqa: PLC0415  (optional)
    import vmas  # noqa: PLC0415

    env: Any = vmas.make_env(
        scenario, num_envs, device="cpu", continuous_actions=True, seed=0, n_agents=NUM_AGENTS
    )
    drawn = [env.get_random_actions() for _ in range(DRAWN)]
    steps = 0

    def take(actions: list) -> int:
        nonlocal steps
        env.step(actions)
        steps += 1
        if steps % _HORIZON == 0:
            env.reset()
        return num_envs * NUM_AGENTS

    def run(seconds: float) -> float:
        threads_before = torch.get_num_threads()
        torch.set_num_threads(threads)
        env.reset()
        take(drawn[0])
        rate = clocked(take, drawn, seconds)
        torch.set_num_threads(threads_before)
        return rate

    return run


def prepare_peers(num_envs: Iterable[int] = _NUM_ENVS) -> dict[Peer, Run]:
    """Return the loop of each installed peer, VMAS with so many environments."""
    runs: dict[Peer, Run] = {}
    missing = missing_packages()
    if "mpe2" not in missing:
        runs[Peer(MPE_SPREAD)] = prepare_mpe()
    if "vmas" not in missing:
        for scenario in _SCENARIOS:
            for count in num_envs:
                for threads in _THREADS:
                    run = prepare_vmas(scenario, count, threads)
                    runs[Peer(f"VMAS {scenario}", count, threads)] = run
    return runs


def peer_rates(repetitions: int = 3, seconds: float = 1.0) -> dict[str, float]:
    """Return agent-steps/s of every row, medians; rows take turns.

    Args:
        repetitions: Repetitions of every measurement.
        seconds: Duration of one measurement [s].
    """
    runs = {str(peer): functools.partial(run, seconds) for peer, run in prepare_peers().items()}
    return medians_in_turns(runs, repetitions)


def main(repetitions: int = 3, seconds: float = 1.0) -> None:
    """Measure the installed peers.

    Args:
        repetitions: Repetitions of every measurement; the table shows medians.
        seconds: Duration of one measurement [s].
    """
    title = f"peers on their own tasks, {NUM_AGENTS} agents, random actions"
    table = new_table(title, "what", "agent-steps/s")
    for name, rate in peer_rates(repetitions, seconds).items():
        table.add_row(name, rate_text(rate))
    missing = missing_packages()
    if missing:
        table.caption = f"left out, not installed: {', '.join(missing)}"
    Console(width=100).print(table)


if __name__ == "__main__":
    tyro.cli(main)
