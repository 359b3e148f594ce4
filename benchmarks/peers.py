"""What other multi-agent simulators do on their own tasks: agent-steps per second, random actions.

``python -m benchmarks.peers`` prints the table. The peers are optional:
``pip install 'mpe2>=1.1' 'vmas>=1.5'`` brings them, and the rows of one that is missing are left
out. (mpe2 before 1.1 wants ``pygame``, which cannot live beside ``pygame-ce``.) Their tasks differ
from this project's and from each other, so the figures tell orders of magnitude and no more.
"""

import functools
import importlib.util
import itertools
import time
from collections.abc import Callable
from typing import Any

import tyro
from rich.console import Console
from rich.table import Table

from benchmarks.turns import medians_in_turns

PACKAGES = ("mpe2", "vmas")
_AGENTS = 2
_HORIZON = 100  # steps after which VMAS's worlds are reset, all at once
_NUM_ENVS = (1, 1_024, 16_384)
_THREADS = (1, 2)
_DRAWN = 16  # actions are drawn before the clock runs and used in turn

Run = Callable[[float], float]  # for so many seconds; returns agent-steps/s


def missing_packages() -> list[str]:
    """Return the packages whose rows are left out."""
    return [name for name in PACKAGES if importlib.util.find_spec(name) is None]


def simple_spread(seconds: float) -> float:
    """Run MPE's simple_spread, one environment; resets included."""
    from mpe2 import simple_spread_v3  # noqa: PLC0415  (optional)

    env = simple_spread_v3.parallel_env(N=_AGENTS)
    env.reset(seed=0)
    drawn = [
        {agent: env.action_space(agent).sample() for agent in env.agents} for _ in range(_DRAWN)
    ]
    agent_steps, start = 0, time.perf_counter()
    for actions in itertools.cycle(drawn):
        env.step(actions)
        agent_steps += _AGENTS
        if not env.agents:
            env.reset()
        elapsed = time.perf_counter() - start
        if elapsed >= seconds:
            break
    env.close()
    return agent_steps / elapsed


def prepare_vmas(scenario: str, num_envs: int, threads: int) -> Run:
    """Return what runs a scenario of VMAS on the CPU, resets included; it warms up here."""
    import torch  # noqa: PLC0415  (optional)
    import vmas  # noqa: PLC0415

    env: Any = vmas.make_env(
        scenario, num_envs, device="cpu", continuous_actions=True, seed=0, n_agents=_AGENTS
    )
    drawn = [env.get_random_actions() for _ in range(_DRAWN)]

    def run(seconds: float) -> float:
        threads_before = torch.get_num_threads()
        torch.set_num_threads(threads)
        env.reset()
        env.step(drawn[0])
        start = time.perf_counter()
        for step, actions in enumerate(itertools.cycle(drawn), 1):
            env.step(actions)
            if step % _HORIZON == 0:
                env.reset()
            elapsed = time.perf_counter() - start
            if elapsed >= seconds:
                break
        torch.set_num_threads(threads_before)
        return step * num_envs * _AGENTS / elapsed

    return run


def _prepare() -> dict[str, Run]:
    """Return the rows of the table and what measures them."""
    runs: dict[str, Run] = {}
    missing = missing_packages()
    if "mpe2" not in missing:
        runs["MPE2 simple_spread, 1 env"] = simple_spread
    if "vmas" not in missing:
        for scenario in ("navigation", "kinematic_bicycle"):
            for num_envs in _NUM_ENVS:
                for threads in _THREADS:
                    unit = "env" if num_envs == 1 else "envs"
                    plural = "thread" if threads == 1 else "threads"
                    name = f"VMAS {scenario}, {num_envs:,} {unit}, {threads} {plural}"
                    runs[name] = prepare_vmas(scenario, num_envs, threads)
    return runs


def peer_rates(repetitions: int = 3, seconds: float = 1.0) -> dict[str, float]:
    """Return agent-steps/s of every row, medians; rows take turns.

    Args:
        repetitions: of every measurement.
        seconds: that one measurement takes.
    """
    runs = {name: functools.partial(run, seconds) for name, run in _prepare().items()}
    return medians_in_turns(runs, repetitions)


def main(repetitions: int = 3, seconds: float = 1.0) -> None:
    """Measure the peers that are installed.

    Args:
        repetitions: of every measurement; the table shows medians.
        seconds: that one measurement takes.
    """
    table = Table(title=f"peers on their own tasks, {_AGENTS} agents, random actions")
    table.add_column("what")
    table.add_column("agent-steps/s", justify="right")
    for name, rate in peer_rates(repetitions, seconds).items():
        table.add_row(name, f"{rate:,.0f}")
    missing = missing_packages()
    if missing:
        table.caption = f"left out, not installed: {', '.join(missing)}"
    Console(width=100).print(table)


if __name__ == "__main__":
    tyro.cli(main)
