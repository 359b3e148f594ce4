"""This module converts columns of observations, one number per lane, to rows, one per HAV."""

from hav_env.compiled import TILE_SIDE, kernel, transpose_tile


@kernel
def write_rows(columns, lanes, rows):
    """Write rows[lane, column] = columns[column, lane] for the first lanes, tile by tile.

    Args:
        columns: (D, L) float32 with D at least ``TILE_SIDE``, as in every observation.
        lanes: Number of lanes.
        rows: (W, D) float32 to write, with W at least ``lanes``.
    """
    most, whole = columns.shape[0], lanes // TILE_SIDE * TILE_SIDE
    for lane in range(0, whole, TILE_SIDE):
        for column in range(0, most - TILE_SIDE, TILE_SIDE):
            transpose_tile(columns, column, lane, rows, lane, column)
        last = most - TILE_SIDE  # the last tile may overlap the one before
        transpose_tile(columns, last, lane, rows, lane, last)
    for lane in range(whole, lanes):
        for column in range(most):
            rows[lane, column] = columns[column, lane]
