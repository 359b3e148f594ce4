"""This module acts between the iterations of PPO: log, bar, evaluations, checkpoints."""

import json
import time
from typing import Any

import numpy as np
import torch
from stable_baselines3.common.callbacks import BaseCallback

from baselines.cli.progress import new_bar
from baselines.storage.atomic_files import write_text
from hav_env.evaluation.figures import goal_hits
from train.curriculum import reward_at
from train.sb3.warm_start import let_policy_learn
from train.scores import evaluate, score


class TrainingCallback(BaseCallback):
    """The callback of one call of ``learn``: a run that resumes has several."""

    def __init__(self, run: Any) -> None:
        """Prepare the callback of a ``train.ppo.Run``, new or resumed."""
        super().__init__()
        self.run = run
        self.begun, self.spent = time.monotonic(), run.seconds
        self.first = run.learner.num_timesteps
        self.ended: list[dict[str, Any]] = []  # infos of episodes since the last log
        self.bar = new_bar("decisions")
        total = run.arguments.decisions
        self.task = self.bar.add_task("", total=total, completed=self.first, rate="")

    def __enter__(self) -> "TrainingCallback":
        """Show the bar."""
        self.bar.start()
        return self

    def __exit__(self, *error: object) -> None:
        """Remove the bar."""
        self.bar.stop()

    def _on_step(self) -> bool:
        infos = self.locals["infos"]
        self.ended += [infos[row] for row in np.flatnonzero(self.locals["dones"])]
        return True

    def _on_rollout_start(self) -> None:
        """Log, evaluate and write the checkpoint, after an update and before the next rollout."""
        run, done = self.run, self.num_timesteps
        if done == self.first:
            run.restore_random_numbers()
        arguments = run.arguments
        progress = done / arguments.decisions
        run.process.set_reward(reward_at(arguments.curriculum, arguments.reward, progress))
        let_policy_learn(run.learner.policy, done >= arguments.value_decisions)
        with torch.no_grad():
            run.learner.policy.log_std.clamp_(min=float(np.log(arguments.least_deviation)))
        run.seconds = self.spent + time.monotonic() - self.begun
        self._log()
        each = arguments.worlds * run.process.num_havs * arguments.rollout_decisions
        if done > self.first:
            if done % arguments.evaluate_every < each:
                self._evaluate()
            if done % arguments.checkpoint_every < each:
                run.write_checkpoint()
        self._show_progress()

    def _on_training_end(self) -> None:
        self.run.seconds = self.spent + time.monotonic() - self.begun
        self._log()
        self._evaluate()
        self.logger.dump(self.num_timesteps)  # SB3 does not flush the logger after the last rollout
        self.run.write_checkpoint()
        self._show_progress()  # no rollout begins after the last one

    def _show_progress(self) -> None:
        """Show decisions, their rate and the last hits of goals in the bar."""
        done, curve = self.num_timesteps, self.run.curve
        rate = (done - self.first) / max(time.monotonic() - self.begun, 1e-9)
        last = curve[-1] if curve else {}
        told = f"{rate:,.0f}/s" + "".join(
            f", {name} {100 * last[name]:.1f} %" for name in goal_hits(list(last))
        )
        self.bar.update(self.task, completed=done, rate=told)

    def _log(self) -> None:
        """Log the means over episodes of all reward terms and all events."""
        ended, self.ended = self.ended, []
        for name in ended[0] if ended else ():
            if isinstance(ended[0][name], float) and name not in ("seed", "episode_number"):
                self.logger.record(f"episodes/{name}", np.mean([info[name] for info in ended]))
        self.logger.record("episodes/count", len(ended))

    def _evaluate(self) -> None:
        """Score the policy on the held-out episodes; save it as last, and as best if it is."""
        run = self.run
        arguments = run.arguments
        found = evaluate(run.policy(), arguments, arguments.evaluation_episodes)
        for name, value in found.items():
            self.logger.record(f"held_out/{name.replace(' / ', '_per_').replace(' ', '_')}", value)
        best = max((row["score"] for row in run.curve), default=-np.inf)
        row = {"decisions": self.num_timesteps, "hours": run.seconds / 3_600, **found}
        run.curve.append(row | {"score": score(found)})
        write_text(json.dumps(run.curve, indent=1) + "\n", run.arguments.output / "curve.json")
        run.save("last.policy")
        if run.curve[-1]["score"] > best:
            run.save("best.policy")
