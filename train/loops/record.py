"""This module evaluates and keeps the policies of an own loop, in the folder of its run."""

import json
import time
from typing import Any

import numpy as np

from baselines.cli.progress import new_bar
from baselines.policies.files import save_policy
from baselines.policies.network import Network
from baselines.storage.atomic_files import write_text
from hav_env.evaluation.figures import goal_hits
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.models.text import visible
from train.export import network_of
from train.loops.moments import CLIPPED, Normalizer
from train.loops.networks import Actor, linear_layers
from train.runs import about_of, plain, versions
from train.scores import conclude, evaluate, score, show_figures


def policy_of(actor: Actor, seen: Normalizer, process: DecisionProcess) -> Network:
    """Return the policy of an actor, without noise."""
    layers, pool = [*linear_layers(actor.body.hidden), actor.output], actor.body.pool
    encoder = linear_layers(pool.encoder) if pool else None
    return network_of(layers, process, seen.mean, seen.variance, CLIPPED, encoder)


class Record:
    """The curve, the best and the last policy of a run, and its bar; a context manager."""

    def __init__(self, algorithm: str, arguments: Any) -> None:
        """Begin a record.

        Args:
            algorithm: Name of the algorithm, for the files.
            arguments: The arguments of the run.
        """
        self.algorithm, self.arguments = algorithm, arguments
        self.curve: list[dict[str, float]] = []
        self._begun, self._evaluated = time.monotonic(), 0
        self._bar = new_bar("decisions")
        self._task = self._bar.add_task("", total=arguments.decisions, rate="")

    def __enter__(self) -> "Record":
        """Show the bar."""
        self._bar.start()
        return self

    def __exit__(self, *error: object) -> None:
        """Remove the bar."""
        self._bar.stop()

    def note(self, decisions: int, policy: Network, figures: dict[str, float]) -> None:
        """Show the progress after an update; evaluate the policy when it is due, and at the end.

        Args:
            decisions: Number of actions so far.
            policy: The policy after the update.
            figures: Figures of the update and of training episodes, for the curve.
        """
        told, seconds = self.arguments, time.monotonic() - self._begun
        if decisions - self._evaluated >= told.evaluate_every or decisions >= told.decisions:
            self._evaluated = decisions
            self._evaluate(decisions, seconds, policy, figures)
        last = self.curve[-1] if self.curve else {}
        hits = [f"{name} {100 * last[name]:.1f} %" for name in goal_hits(list(last))]
        shown = ", ".join([f"{decisions / max(seconds, 1e-9):,.0f}/s", *hits])
        self._bar.update(self._task, completed=decisions, rate=shown)

    def _evaluate(
        self, decisions: int, seconds: float, policy: Network, figures: dict[str, float]
    ) -> None:
        """Score a policy on the held-out episodes; save it as last, and as best if it is."""
        told = self.arguments
        found = evaluate(policy, told, told.evaluation_episodes)
        best = max((row["score"] for row in self.curve), default=-np.inf)
        row = {"decisions": decisions, "hours": seconds / 3_600, **found, "score": score(found)}
        training = {f"training {name}": value for name, value in figures.items()}
        self.curve.append(row | training)
        write_text(json.dumps(self.curve, indent=1) + "\n", told.output / "curve.json")
        about = {
            "algorithm": self.algorithm,
            "arguments": plain(told),
            "decisions": decisions,
            "began_with": about_of(told.begin_with),
            "hours": seconds / 3_600,
            "curve": self.curve,
            **versions(),
        }
        save_policy(policy, told.output / "last.policy", about, told.safety, told.backup)
        if row["score"] > best:
            save_policy(policy, told.output / "best.policy", about, told.safety, told.backup)

    def conclude(self) -> str:
        """Score the best policy on episodes that chose nothing; return the figures as text."""
        best = self.arguments.output / "best.policy"
        found = conclude(best, self.arguments, self.arguments.scored_episodes)
        return f"{show_figures(found)}\npolicy: {visible(str(best))}"
