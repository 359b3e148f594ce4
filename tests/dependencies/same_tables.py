"""This module compares tables of episodes to the bit, whatever releases wrote them."""

import sys

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq


def differing(one: pa.Table, other: pa.Table) -> list[str]:
    """Return the columns of which any bit differs; NaNs of the same bits are equal."""
    if one.column_names != other.column_names:
        return sorted(set(one.column_names) ^ set(other.column_names)) or ["the order of columns"]
    pairs = [(name, one[name], other[name]) for name in one.column_names]
    return [name for name, ours, theirs in pairs if _bits(ours) != _bits(theirs)]


def _bits(column: pa.ChunkedArray) -> list:
    """Return the type, the lengths of lists, what is missing, and the bits of what is there."""
    if pa.types.is_list(column.type):
        lengths = [None if row is None else len(row) for row in column.to_pylist()]
        return [
            lengths,
            *_bits(pa.chunked_array([a.flatten() for a in column.chunks], column.type.value_type)),
        ]
    missing = column.is_null().to_pylist()
    values = np.asarray(column.drop_null().to_pylist())
    return [str(column.type), missing, values.dtype.str, values.tobytes()]


if (
    __name__ == "__main__"
):  # python -m tests.dependencies.same_tables one.parquet another.parquet ...
    first, *others = sys.argv[1:]
    for path in others:
        if found := differing(pq.read_table(first), pq.read_table(path)):
            sys.exit(f"error: {path} differs from {first} in {', '.join(found)}")
    print(f"{len(others) + 1} tables are equal to the bit: {' '.join(sys.argv[1:])}")
