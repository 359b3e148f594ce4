"""Angles are wrapped by whole turns, values clipped, and differences turned into a frame."""

import math

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from hav_env.maths.geometry import clip, into_frame, wrap

angles = st.floats(-100.0, 100.0)


@example(math.pi)
@example(-math.pi)
@example(3.0 * math.pi)
@given(angles)
def test_wrapping_moves_by_whole_turns_into_half_a_turn_each_side(angle):
    result = wrap(angle)
    turns = (angle - result) / math.tau
    assert turns == pytest.approx(round(turns), abs=1e-12)
    assert -math.pi - 1e-12 <= result <= math.pi


@given(st.floats(-math.pi, 3.14))
def test_wrapping_leaves_a_wrapped_angle_alone(angle):
    assert wrap(angle) == angle


@given(st.floats(-9, 9), st.floats(-9, 9), st.floats(0, 9))
def test_clipping_is_the_nearest_value_within_the_bounds(value, low, span):
    high = low + span
    result = clip(value, low, high)
    assert low <= result <= high
    assert result == value or not low <= value <= high
    assert abs(value - result) == min(abs(value - low), abs(value - high)) or result == value


@given(st.floats(-50, 50), st.floats(-50, 50), angles)
def test_into_a_frame_is_a_rotation_against_its_heading(dx, dy, heading):
    forward, left = into_frame(dx, dy, math.cos(heading), math.sin(heading))
    turned = complex(dx, dy) * complex(math.cos(heading), -math.sin(heading))
    assert complex(forward, left) == pytest.approx(turned, abs=1e-12)
