"""Worlds in single precision are drawn and described as those in double precision are."""

import json

import gymnasium as gym
import numpy as np
import pytest

from hav_env import (
    HAVVecEnv,
    OffAxle,
    Rectangles,
    build_site,
    explicit,
    find_scenario,
)
from hav_env.rendering import describe, scene_of
from hav_env.rendering.viewer import Viewer
from tests.support.worlds import catalogue_like, sample

SWARM = "hav_env:HAVSwarm-v0"
YARD = build_site([[0, 0], [60, 0], [60, 50], [0, 50]], circles=[[30, 28, 3]])
WORLDS = {
    "pair": lambda: sample(find_scenario("paper-pair"), 1),
    "bodies": lambda: catalogue_like(OffAxle(bodies=Rectangles())).worlds,
    "walls": lambda: sample(explicit([[3, 4]], [[10, 20, 0]], [[[40, 40, 0]]], site=YARD), 1),
}


def narrowed(part):
    """Return worlds, or a part of them, with float32 in place of float64."""
    if isinstance(part, tuple):
        parts = map(narrowed, part)
        return type(part)(*parts) if hasattr(part, "_fields") else tuple(parts)
    wide = isinstance(part, np.ndarray) and part.dtype == np.float64
    return part.astype(np.float32) if wide else part


def assert_alike(one, other):
    """Check that two pictures differ in few pixels, at edges that rounding moves."""
    assert (one != other).any(axis=-1).mean() < 0.003


@pytest.mark.parametrize("make", WORLDS.values(), ids=WORLDS)
def test_pictures_are_nearly_those_of_double_precision(make):
    worlds = make()
    pictures, texts = [], []
    for one in (worlds, narrowed(worlds)):
        evaded = np.roll(np.arange(len(worlds.state.x)), 1) if len(worlds.state.x) > 1 else None
        command = narrowed(np.ones((len(worlds.state.x), 2)))
        scene = scene_of(one, 0, 0.2, evaded, command)
        viewer = Viewer("rgb_array", own=0)
        pictures.append(viewer.draw(scene))
        texts.append(describe(scene))
        arrays = [part for part in scene if isinstance(part, np.ndarray)]
        assert np.float32 not in {part.dtype for part in arrays}
        json.dumps([part.ravel()[0].item() for part in arrays if part.size])
    assert_alike(*pictures)
    assert texts[0] == texts[1]


def test_environments_draw_in_single_precision():
    envs = [gym.make(SWARM, render_mode="rgb_array", precision=p) for p in ("double", "single")]
    pictures = []
    for env in envs:
        env.reset(seed=0)
        env.step(np.full((2, 2), 0.5, np.float32))
        pictures.append(env.render())
    assert_alike(*pictures)


@pytest.mark.exhaustive
@pytest.mark.parametrize(
    "settings",
    [
        {"scenario": "crossing-8"},
        {"vehicle": "limited"},
        {"scenario": "yard-4"},
        {"scenario": "field-1", "vehicle": "realistic"},
    ],
    ids=str,
)
def test_every_kind_of_world_is_drawn_in_single_precision(settings):
    pictures = []
    for precision in ("double", "single"):
        env = HAVVecEnv(1, render_mode="rgb_array", precision=precision, **settings)
        env.seed(0)
        env.reset()
        for _ in range(3):
            env.step(np.full((env.num_envs, 2), 0.4))
        pictures.append(env.get_images()[0])
    assert_alike(*pictures)
