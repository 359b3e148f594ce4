"""The bar of a training ends where its last rollout does."""

from types import SimpleNamespace

import pytest

from train.sb3.callback import TrainingCallback


@pytest.mark.parametrize(("total", "done"), [(4_000, 4_096), (2_000, 2_048)])
def test_the_bar_shows_the_last_rollout(total, done, monkeypatch):
    run = SimpleNamespace(
        seconds=0.0,
        curve=[],
        learner=SimpleNamespace(num_timesteps=0),
        arguments=SimpleNamespace(decisions=total),
        write_checkpoint=lambda: None,
    )
    callback = TrainingCallback(run)
    callback.model = SimpleNamespace(logger=SimpleNamespace(dump=lambda step: None))
    for name in ("_log", "_evaluate"):
        monkeypatch.setattr(callback, name, lambda: None)
    callback.num_timesteps = done
    callback._on_training_end()
    assert callback.bar.tasks[0].completed == done
