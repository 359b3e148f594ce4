"""A path of segments has the length and the turns of its segments."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.prediction.paths import (
    append,
    heading_at,
    total_length,
)


@given(st.lists(st.tuples(st.floats(-0.5, 0.5), st.floats(0.1, 50.0)), max_size=7))
def test_the_heading_along_a_path_is_the_sum_of_its_turns(path):
    rows = np.zeros(m.ROWS)
    for curvature, length in path:
        append(rows, m.CURRENT_PATH, curvature, length)
    total = sum(length for _, length in path)
    assert total_length(rows, m.CURRENT_PATH) == pytest.approx(total)
    turned = sum(curvature * length for curvature, length in path)
    assert heading_at(rows, m.CURRENT_PATH, total + 1.0) == pytest.approx(turned)
    if path:
        curvature, length = path[0]
        assert heading_at(rows, m.CURRENT_PATH, 0.5 * length) == pytest.approx(
            0.5 * curvature * length
        )
    assert heading_at(rows, m.CURRENT_PATH, -1.0) == 0.0
