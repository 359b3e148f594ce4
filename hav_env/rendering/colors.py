"""This module chooses colours for the ground, each HAV and danger, for any colour vision.

The HAVs' colours differ in lightness where hue alone could mislead. Each stands out from the ground
(contrast of at least 3). Only danger is amber or red.
"""

import functools

Color = tuple[int, int, int]

GROUND: Color = (248, 248, 245)
GRID: Color = (233, 233, 228)
PAPER: Color = (255, 255, 255)
INK: Color = (38, 44, 52)
DIM: Color = (116, 124, 134)
PALE: Color = (206, 210, 214)
CALM: Color = (96, 106, 118)
AMBER: Color = (230, 150, 0)
RED: Color = (214, 16, 32)
EVASION: Color = (224, 118, 0)
EVENT_COLORS = {"alert": RED, "warning": AMBER}  # as hav_env.world.event_table names them

PALETTE: tuple[Color, ...] = (
    (0, 114, 178),  # blue
    (0, 122, 82),  # green
    (206, 100, 168),  # pink
    (84, 48, 24),  # brown
    (44, 30, 110),  # indigo
    (64, 64, 228),  # ultramarine
    (92, 98, 112),  # slate
)


def color_of(hav: int) -> Color:
    """Return the colour of a HAV; they repeat after seven."""
    return PALETTE[hav % len(PALETTE)]


@functools.lru_cache(1024)
def mix(color: Color, other: Color, share: float) -> Color:
    """Return a colour with a share in [0, 1] of another one mixed in."""
    red, green, blue = (round(a + share * (b - a)) for a, b in zip(color, other, strict=True))
    return red, green, blue


def color_of_bend(nearness: float) -> Color:
    """Return the colour of an articulation: calm, amber near its limit, red at it.

    Args:
        nearness: share of the limit, from 0.
    """
    if nearness < 0.5:
        return CALM
    if nearness < 0.75:
        return mix(CALM, AMBER, (nearness - 0.5) / 0.25)
    return mix(AMBER, RED, min((nearness - 0.75) / 0.2, 1.0))
