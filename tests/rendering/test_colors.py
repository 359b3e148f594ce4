"""HAVs differ in colour for any colour vision, and stand out from light and dark grounds.

Differences are CIEDE2000 (CIE 142-2001), checked on pairs of Sharma, Wu and Dalal (2005), Color
Research & Application 30. Vision is simulated with the matrices of severity 1.0 of Machado,
Oliveira and Fernandes (2009), IEEE Transactions on Visualization and Computer Graphics 15(6), for
linear RGB.
"""

import itertools
import re

import numpy as np
import pytest

from baselines.figures.trajectory_plot import HAV_COLORS
from baselines.replay.web_page import template
from hav_env.rendering import colors
from tests.rendering.test_rendering import SIZE, frame_of, scene, where

VISIONS = {
    "normal": np.eye(3),
    "protanopia": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deuteranopia": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    "tritanopia": [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
}
TO_XYZ = np.array(
    [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ]
)
PALETTES = {"light": colors.PALETTE, "dark": colors.DARK_GROUND_PALETTE}


def linear(palette) -> np.ndarray:
    """Return linear RGB of colours (K, 3) of sRGB."""
    share = np.asarray(palette) / 255.0
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


def lab(rgb: np.ndarray) -> np.ndarray:
    """Return CIE Lab of linear RGB (K, 3)."""
    xyz = rgb @ TO_XYZ.T / TO_XYZ.sum(axis=1)  # over the white of D65
    x, y, z = np.where(xyz > 216 / 24389, np.cbrt(xyz), (24389 / 27 * xyz + 16) / 116).T
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)


def ciede2000(one, other) -> float:
    """Return the difference of two colours in CIE Lab, by the formulas of Sharma and others."""
    (l1, a1, b1), (l2, a2, b2) = one, other
    mean = (np.hypot(a1, b1) + np.hypot(a2, b2)) / 2
    stretch = 1.5 - 0.5 * np.sqrt(mean**7 / (mean**7 + 25.0**7))
    c1, c2 = np.hypot(stretch * a1, b1), np.hypot(stretch * a2, b2)
    h1, h2 = (np.degrees(np.arctan2(b, stretch * a)) % 360 for a, b in ((a1, b1), (a2, b2)))
    gray, apart = c1 * c2 == 0, abs(h1 - h2) > 180
    turn = 0.0 if gray else (h2 - h1 + 180) % 360 - 180
    hue = h1 + h2 if gray else (h1 + h2 + 360 * apart * (1 if h1 + h2 < 360 else -1)) / 2
    light, chroma = (l1 + l2) / 2, (c1 + c2) / 2
    waves = zip((-0.17, 0.24, 0.32, -0.20), (1, 2, 3, 4), (-30, 0, 6, -63), strict=True)
    t = 1 + sum(size * np.cos(np.radians(k * hue + shift)) for size, k, shift in waves)
    rotation = -np.sin(np.radians(60 * np.exp(-(((hue - 275) / 25) ** 2))))
    rotation *= 2 * np.sqrt(chroma**7 / (chroma**7 + 25.0**7))
    of_l = (l2 - l1) / (1 + 0.015 * (light - 50) ** 2 / np.sqrt(20 + (light - 50) ** 2))
    of_c = (c2 - c1) / (1 + 0.045 * chroma)
    of_h = 2 * np.sqrt(c1 * c2) * np.sin(np.radians(turn / 2)) / (1 + 0.015 * chroma * t)
    return float(np.sqrt(of_l**2 + of_c**2 + of_h**2 + rotation * of_c * of_h))


def contrast(one, other) -> float:
    """Return the contrast ratio of two colours by WCAG 2."""
    high, low = sorted((linear(np.array([one, other])) @ TO_XYZ[1]).tolist(), reverse=True)
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize(
    ("one", "other", "difference"),
    [
        ((50.0, 2.6772, -79.7751), (50.0, 0.0, -82.7485), 2.0425),
        ((50.0, 2.49, -0.001), (50.0, -2.49, 0.0011), 7.2195),
        ((50.0, 2.5, 0.0), (73.0, 25.0, -18.0), 27.1492),
        ((50.0, 2.5, 0.0), (58.0, 24.0, 15.0), 19.4535),
        ((2.0776, 0.0795, -1.135), (0.9033, -0.0636, -0.5514), 0.9082),
    ],
)
def test_differences_are_those_of_sharma(one, other, difference):
    assert ciede2000(one, other) == pytest.approx(difference, abs=1e-4)
    assert ciede2000(other, one) == pytest.approx(difference, abs=1e-4)


@pytest.mark.parametrize("palette", PALETTES)
@pytest.mark.parametrize("vision", VISIONS)
def test_any_two_colours_differ_for_any_vision(palette, vision):
    seen = lab(np.clip(linear(PALETTES[palette]) @ np.transpose(VISIONS[vision]), 0.0, 1.0))
    assert len(seen) == 12
    least = min(ciede2000(*pair) for pair in itertools.combinations(seen, 2))
    assert least >= colors.LEAST_DIFFERENCE


def grounds_of_the_page() -> list[tuple[int, ...]]:
    """Return the grounds and panels of the page, first of the light theme, then of the dark one."""
    found = re.findall(r"--(?:ground|panel): #(\w\w)(\w\w)(\w\w)", template())
    return [tuple(int(part, 16) for part in color) for color in found]


def test_colours_stand_out_from_every_ground():
    grounds = grounds_of_the_page()
    assert len(grounds) == 4
    light = [colors.GROUND, colors.PAPER, *grounds[:2]]
    for palette, behind in ((colors.PALETTE, light), (colors.DARK_GROUND_PALETTE, grounds[2:])):
        for color, ground in itertools.product(palette, behind):
            assert contrast(color, ground) >= 3.0, (color, ground)


def test_no_hav_has_a_colour_of_danger():
    danger = lab(linear([colors.RED, colors.AMBER, colors.EVASION]))
    for seen in lab(linear(colors.PALETTE)):
        assert min(ciede2000(seen, one) for one in danger) >= colors.LEAST_DIFFERENCE


def test_plots_have_the_same_colours_as_films():
    assert HAV_COLORS[1] == "#672500"
    assert [colors.web_color(colors.color_of(hav)) for hav in range(24)] == [*HAV_COLORS] * 2


def test_havs_of_one_colour_differ_in_pattern():
    looks = {(colors.color_of(hav), colors.pattern_of(hav)) for hav in range(48)}
    assert len(looks) == 48
    assert {colors.pattern_of(hav) for hav in range(12)} == {"plain"}


def test_patterns_are_drawn_on_havs():
    counts = []
    for hav in (0, 12, 24, 36):  # the same HAV under other numbers
        others = np.arange(hav + 1) < hav
        alone = scene(hav + 1, y=np.zeros(hav + 1), removed=others)
        alone = alone._replace(goal=np.tile([40.0, 0.0, 0.0], (hav + 1, 1)))
        counts.append(len(where(frame_of(alone, size=SIZE), colors.PAPER)))
    assert len(set(counts)) == 4
