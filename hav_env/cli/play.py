"""This module lets you drive one HAV by keyboard among others that a policy drives.

Keys: up and down (W and S) change the speed, left and right (A and D) steer, R begins a new
episode, escape ends. Those of the window are in ``hav_env.rendering.viewer``.
"""

import dataclasses
from collections.abc import Callable, Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np


@dataclasses.dataclass
class Play:
    """The options of a game."""

    num_havs: int | None = None
    """HAVs, of which you drive one; by default as many as the scenario has, or 4."""
    scenario: str | None = None
    """A scenario by its name, or FILE.json; by default random poses."""
    seed: int = 0
    """Seed of the first episode; each new one takes the next."""
    others: str = "avoid_jack"
    """The policy that drives the others, by its name."""
    vehicle: str = "on_axle"
    """The kinematics of all HAVs, by name or module:Class."""
    reward: str = "default"
    """The reward, by name or module:Class."""


class Controls(NamedTuple):
    """Changes of the action per frame while a key is held; the whole range is 2."""

    throttle: float = 0.08
    steer: float = 0.12
    release: float = 0.2


_HAVS = 4  # where neither a number nor a scenario is given
STANDING_ACTION = (
    -1.0,
    0.0,
)  # speed from -1, none, to 1, the most; steering from -1, right, to 1, left


def next_action(
    held: frozenset[str], action: np.ndarray, controls: Controls = Controls()
) -> np.ndarray:
    """Return the action that follows another one while keys are held.

    The speed stays when neither key is held; the steering returns to the middle.

    Args:
        held: the held keys, of "faster", "slower", "left", "right".
        action: (2,) the previous one: speed and steering, each in [-1, 1].
        controls: how quickly it changes.
    """
    speed, steering = (float(value) for value in action)
    speed += controls.throttle * (("faster" in held) - ("slower" in held))
    side = ("left" in held) - ("right" in held)
    if side:
        steering += controls.steer * side
    else:
        steering -= float(np.clip(steering, -controls.release, controls.release))
    return np.clip(np.array([speed, steering], np.float32), -1.0, 1.0)


def drive(
    env: Any,
    held_in_frames: Iterable[frozenset[str]],
    seed: int = 0,
    controls: Controls = Controls(),
    tell: Callable[[str], object] = print,
) -> int:
    """Drive an environment of one HAV as long as there are frames, or until "quit" is held.

    After the end of an episode the picture stands until "again" is held.

    Args:
        env: with ``reset(seed=)``, ``step(action)`` and ``render()`` as Gymnasium's for humans:
            the first two show a frame by themselves.
        held_in_frames: the held keys of each frame: see ``next_action``; and "again", "quit".
        seed: of the first episode; each new one takes the next, after the last one 0.
        controls: how quickly the action changes.
        tell: function that takes how each episode ended.

    Returns:
        How many episodes were begun.
    """
    from hav_env.maths.random_numbers import SEED_LIMIT  # noqa: PLC0415  takes the compiler's time

    episodes, running, before = 0, False, frozenset({"again"})
    action = np.array(STANDING_ACTION, np.float32)
    for held in held_in_frames:
        if "quit" in held:
            break
        if episodes == 0 or ("again" in held and "again" not in before):
            env.reset(seed=(seed + episodes) % SEED_LIMIT)
            episodes, running, action = episodes + 1, True, np.array(STANDING_ACTION, np.float32)
        elif running:
            action = next_action(held, action, controls)
            _, _, terminated, truncated, info = env.step(action)
            if terminated or truncated:
                running = False
                tell(f"{_outcome(info)}; R begins a new episode")
        else:
            env.render()
        before = held
    return episodes


def _outcome(info: dict[str, Any]) -> str:
    """Say in a few words how an episode ended."""
    from hav_env.world.event_table import HARM  # noqa: PLC0415  takes the compiler's time

    flags = {"is_success": "goals reached", **{event.name: event.state for event in HARM}}
    told = [text for flag, text in flags.items() if info.get(flag)]
    return ", ".join(told) or "time is over"


def watch_keyboard() -> Iterator[frozenset[str]]:
    """Yield what is held in each frame, as long as there is a window.

    The window opens when the first frame is rendered, and the viewer takes in its events.

    Raises:
        ImportError: without pygame-ce.
    """
    from hav_env.rendering.canvas import pygame  # noqa: PLC0415  says what is missing

    meanings = {
        "faster": (pygame.K_UP, pygame.K_w),
        "slower": (pygame.K_DOWN, pygame.K_s),
        "left": (pygame.K_LEFT, pygame.K_a),
        "right": (pygame.K_RIGHT, pygame.K_d),
        "again": (pygame.K_r,),
        "quit": (pygame.K_ESCAPE,),
    }
    yield frozenset()
    while pygame.display.get_init() and pygame.display.get_surface() is not None:
        pressed = pygame.key.get_pressed()
        yield frozenset(name for name, keys in meanings.items() if any(pressed[k] for k in keys))


def open_environment(options: Play, render_mode: str | None = "human") -> Any:
    """Return the environment that is played; its window opens when it is first rendered.

    Raises:
        ValueError, TypeError, OSError: for options that are not allowed, naming them.
    """
    # these need the simulator, the keyboard does not
    from hav_env.envs.gymnasium_single import HAVSingleEnv  # noqa: PLC0415
    from hav_env.simulator.batch import check_seed  # noqa: PLC0415

    check_seed(options.seed)
    chosen: dict[str, Any] = {
        "num_havs": options.num_havs,
        "vehicle": options.vehicle,
        "reward": options.reward,
    }
    if options.scenario is not None:
        chosen["scenario"] = options.scenario
    elif options.num_havs is None:
        chosen["num_havs"] = _HAVS
    return HAVSingleEnv(others=options.others, render_mode=render_mode, **chosen)


def _compile(options: Play) -> None:
    """Take one step without a window, so that compiling does not keep a window from answering."""
    env = open_environment(options, None)
    env.reset(seed=options.seed)
    env.step(np.array(STANDING_ACTION, np.float32))
    env.close()


def play(options: Play) -> None:
    """Open a window and let the user drive until it is closed."""
    env = open_environment(options)
    try:
        _compile(options)
        drive(env, watch_keyboard(), options.seed)
    finally:
        env.close()
