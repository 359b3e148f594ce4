"""This module lets you drive one HAV by keyboard among others that a policy drives.

Keys: up and down (W and S) change the speed, left and right (A and D) steer, R begins a new
episode, escape ends. ``hav_env.rendering.viewer`` has the keys of the window.
"""

import dataclasses
from collections.abc import Callable, Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np

from hav_env.cli.errors import report_errors
from hav_env.cli.options import parse_options


def main(words: list[str]) -> int:
    """Drive one HAV by keyboard among others that a policy drives."""

    def run(words: list[str]) -> None:
        play(parse_options(Play, "hav-env play", _ABOUT_PLAY, words))

    return report_errors(run, words)


@dataclasses.dataclass
class Play:
    """Options of ``hav-env play``."""

    num_havs: int | None = None
    """Number of HAVs, one of which you drive; by default that of the scenario, or 4."""
    scenario: str | None = None
    """Scenario: its name, or FILE.json; by default random poses."""
    site: str | None = None
    """File with the obstacles and the bounds of the scenario."""
    fleet: str | None = None
    """Real vehicles in place of the scenario's, with --vehicle realistic: NAME[,NAME]."""
    seed: int = 0
    """Seed of the first episode; each new episode takes the next seed."""
    others: str = "avoid_jack"
    """Policy of the other HAVs: a name, a file or module:Class."""
    vehicle: str = "on_axle"
    """Kinematics of all HAVs: a name or module:Class."""
    reward: str = "default"
    """Reward: a name or module:Class."""


class Controls(NamedTuple):
    """Changes of the action per frame while a key is held; the range of an action is 2."""

    throttle: float = 0.08
    steer: float = 0.12
    release: float = 0.2


_ABOUT_PLAY = (
    "Drive one HAV by keyboard among others that a policy drives. The window shows the keys."
    " hav-env list shows the names of scenarios, policies, vehicles and rewards."
)
PLAY_KEYS = (
    "up, down or W, S: speed",
    "left, right or A, D: steering",
    "R: new episode    Esc: end",
    "F: follow    + -: zoom    space: pause",
    "T: trails    C: circles    H: hide this",
)
"""Keys, as the window shows them."""
_HAVS = 4  # the default without a number and a scenario
STANDING_ACTION = (
    -1.0,
    0.0,
)  # speed from -1, none, to 1, the most; steering from -1, right, to 1, left


def next_action(
    held: frozenset[str], action: np.ndarray, controls: Controls = Controls()
) -> np.ndarray:
    """Return the next action while keys are held.

    The speed stays when neither key is held; the steering returns to the middle.

    Args:
        held: The held keys, of "faster", "slower", "left", "right".
        action: (2,) The previous action: speed and steering, each in [-1, 1].
        controls: Changes of the action per frame.
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

    After the end of an episode, the window keeps its picture until "again" is held.

    Args:
        env: An environment of Gymnasium with ``render_mode="human"``: ``reset(seed=)`` and
            ``step(action)`` show a frame by themselves.
        held_in_frames: The held keys of each frame: those of ``next_action``, "again" and "quit".
        seed: Seed of the first episode; each new episode takes the next seed. 0 follows the last.
        controls: Changes of the action per frame.
        tell: Function that takes the outcome of each episode as text.

    Returns:
        The number of episodes.
    """
    from hav_env.maths.random_numbers import SEED_LIMIT  # noqa: PLC0415  loads the compiler

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
    """Return the outcome of an episode in a few words."""
    from hav_env.world.event_table import HARM  # noqa: PLC0415  loads the compiler

    flags = {"is_success": "goals reached", **{event.name: event.state for event in HARM}}
    told = [text for flag, text in flags.items() if info.get(flag)]
    return ", ".join(told) or "time is over"


def watch_keyboard() -> Iterator[frozenset[str]]:
    """Yield the held keys of each frame, as long as there is a window.

    The first rendered frame opens the window, and the viewer handles its events.

    Raises:
        ImportError: If pygame-ce is missing.
    """
    from hav_env.rendering.canvas import pygame  # noqa: PLC0415  names a missing extra

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
    """Return the environment of the game; the first frame opens its window.

    Raises:
        ValueError, TypeError, OSError: If an option is invalid; the message names it.
    """
    # these load the simulator, which the keyboard does not need
    from hav_env.envs.gymnasium_single import HAVSingleEnv  # noqa: PLC0415
    from hav_env.simulator.batch import check_seed  # noqa: PLC0415

    check_seed(options.seed)
    chosen: dict[str, Any] = {
        "num_havs": options.num_havs,
        "site": options.site,
        "fleet": options.fleet,
        "vehicle": options.vehicle,
        "reward": options.reward,
    }
    if options.scenario is not None:
        chosen["scenario"] = options.scenario
    elif options.num_havs is None:
        chosen["num_havs"] = _HAVS
    env = HAVSingleEnv(others=options.others, render_mode=render_mode, **chosen)
    screen = env._world.screen
    screen.caption, screen.own = PLAY_KEYS, 0
    return env


def _compile(options: Play) -> None:
    """Take one step without a window, so that no window freezes during compilation."""
    env = open_environment(options, None)
    env.reset(seed=options.seed)
    env.step(np.array(STANDING_ACTION, np.float32))
    env.close()


def play(options: Play) -> None:
    """Open a window and let the user drive until the user closes it."""
    env = open_environment(options)
    try:
        _compile(options)
        drive(env, watch_keyboard(), options.seed)
    finally:
        env.close()
