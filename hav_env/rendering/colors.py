"""This module chooses colours for the ground, each HAV and danger, for any colour vision.

Twelve colours for HAVs were searched by simulated annealing. Any two of them differ by at least
``LEAST_DIFFERENCE`` in CIEDE2000, with normal vision and with protanopia, deuteranopia and
tritanopia as simulated by Machado, Oliveira and Fernandes (2009). Each stands out from the ground
(contrast of at least 3). Only danger is amber or red. Further HAVs have the same colours with a
pattern.
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
    (47, 138, 246),  # sky blue
    (103, 37, 0),  # brown
    (114, 148, 8),  # lime
    (71, 25, 78),  # aubergine
    (172, 124, 148),  # rose
    (10, 66, 55),  # fir
    (69, 56, 254),  # ultramarine
    (26, 101, 133),  # petrol
    (118, 102, 53),  # olive
    (15, 1, 178),  # navy
    (138, 139, 109),  # sage
    (99, 107, 98),  # stone
)
DARK_GROUND_PALETTE: tuple[Color, ...] = (  # in the same order, for a dark ground
    (190, 156, 254),
    (186, 156, 140),
    (94, 113, 82),
    (188, 36, 161),
    (126, 120, 126),
    (55, 250, 207),
    (184, 69, 255),
    (141, 168, 177),
    (144, 115, 1),
    (254, 205, 255),
    (192, 245, 134),
    (48, 194, 17),
)
LEAST_DIFFERENCE = 14.0  # CIEDE2000 between any two colours of a palette
PATTERNS = ("plain", "stripe", "dashes", "dots")  # of the HAVs from each twelfth one on


def color_of(hav: int) -> Color:
    """Return the colour of a HAV; colours repeat after twelve, with another pattern."""
    return PALETTE[hav % len(PALETTE)]


def pattern_of(hav: int) -> str:
    """Return the pattern of a HAV, one of ``PATTERNS``; it repeats after all colours with all."""
    return PATTERNS[hav // len(PALETTE) % len(PATTERNS)]


def web_color(color: Color) -> str:
    """Return a colour as #rrggbb."""
    return "#{:02x}{:02x}{:02x}".format(*color)


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
