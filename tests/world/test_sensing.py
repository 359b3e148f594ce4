"""A HAV senses the world in its own frame, and only in range."""

import math

import numpy as np
import pytest

from hav_env import Task
from hav_env.policies.interface import allocate_memory, decide
from tests.support.policies import FIRST_NEIGHBOR, NEIGHBOR_COLUMNS, Probe
from tests.support.worlds import aim, limit, open_plane, put, wrapped

RANGE = 25.0
NUM_HAVS, NUM_WORLDS = 5, 20


def sense(shift=0j, turn=0.0):
    """Return all sensed quantities in random worlds (N, K, W) that are turned, then shifted."""
    batch = open_plane(NUM_WORLDS, NUM_HAVS, 2, task=Task(sensing_range=RANGE))
    limit(batch.worlds, speed=0.7, steering=0.6, articulation=1.2)
    rng = np.random.default_rng(1)
    scene = {}
    for w in range(NUM_WORLDS):
        for agent in range(NUM_HAVS):
            lengths, headings = rng.uniform(2, 12, 3), rng.uniform(-9, 9, 3)
            place = complex(*rng.uniform(-60, 60, 2))
            goal = complex(*rng.uniform(-60, 60, 2)), rng.uniform(-9, 9)
            scene[agent, w] = lengths, headings, place, goal
            moved = place * np.exp(1j * turn) + shift
            put(batch.worlds, lengths, moved.real, moved.imag, headings + turn, w=w, agent=agent)
            there = goal[0] * np.exp(1j * turn) + shift
            aim(batch.worlds, agent, w, there.real, there.imag, goal[1] + turn)
    batch.worlds.state.waiting[:] = True  # find neighbours, touch nothing
    batch.step(*np.zeros((2, NUM_HAVS, NUM_WORLDS)))
    batch.worlds.state.waiting[:] = False  # a waiting HAV does not sense
    memory = allocate_memory(Probe(), NUM_HAVS, NUM_WORLDS)
    decide(Probe(), memory, batch)
    return memory, scene


def test_a_hav_senses_itself_its_goal_and_who_is_in_range():
    memory, scene = sense()
    for (agent, w), (lengths, headings, place, (goal, goal_heading)) in scene.items():
        row, frame = memory[agent, :, w], np.exp(-1j * headings[0])
        ahead = (goal - place) * frame
        joint = np.exp(1j * (headings[1] - headings[0]))
        own = [2, lengths[0], math.hypot(*lengths), 0.7, 0.6, 1.2, ahead.real, ahead.imag]
        own += [wrapped(goal_heading - headings[0]), sum(lengths[1:]), joint.real, joint.imag]
        assert row[:12] == pytest.approx(own, abs=1e-9)
        assert row[12:15].tolist() == [0, w, 1]  # seed, episode, step
        away = np.exp(1j * goal_heading) * frame
        assert row[15:17] == pytest.approx([away.real, away.imag], abs=1e-9)
        rows = []
        for other in range(NUM_HAVS):
            lengths_, headings_, place_, _ = scene[other, w]
            gap = abs(place_ - place)
            reach = max(lengths[0], sum(lengths[1:])) + max(lengths_[0], sum(lengths_[1:]))
            if other != agent and gap <= reach + RANGE:
                there = (place_ - place) * frame
                turn = wrapped(headings_[1] - headings[0])
                rows += [other, there.real, there.imag, gap, turn, sum(lengths_[1:]), lengths_[1]]
        assert row[FIRST_NEIGHBOR - 1] == len(rows) / NEIGHBOR_COLUMNS
        assert row[FIRST_NEIGHBOR:][: len(rows)] == pytest.approx(rows, abs=1e-9)


@pytest.mark.parametrize(("shift", "turn"), [(1e4 - 3e3j, 0.0), (0j, 2.5), (70 + 80j, -1.1)])
def test_sensing_does_not_depend_on_where_the_world_lies(shift, turn):
    assert sense(shift, turn)[0] == pytest.approx(sense()[0], abs=1e-8)
