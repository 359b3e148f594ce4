"""Tables are equal if all of their bits are."""

import math

import pyarrow as pa

from tests.dependencies.same_tables import differing

COLUMNS = {
    "step": [3, None, 5],
    "length": [0.1, math.nan, 0.0],
    "hit": [True, False, None],
    "units": [[1.0, 2.0], [], [3.0]],
}
TABLE = pa.table(COLUMNS)


def changed(name, values):
    return pa.table(COLUMNS | {name: values})


def test_a_table_equals_itself_however_it_is_cut():
    assert differing(TABLE, pa.concat_tables([TABLE[:1], TABLE[1:]])) == []


def test_every_change_is_named():
    changes = {
        "step": [[3, 4, 5], [3, 5, None], [3.0, None, 5.0]],
        "length": [
            [math.nextafter(0.1, 1), math.nan, 0.0],
            [0.1, math.nan, -0.0],
            [0.1, None, 0.0],
        ],
        "hit": [[True, True, None]],
        "units": [[[1.0], [2.0], [3.0]], [[1.0, 2.0], [], [4.0]]],
    }
    for name, ways in changes.items():
        for values in ways:
            assert differing(TABLE, changed(name, values)) == [name]


def test_columns_that_one_table_lacks_are_named():
    assert differing(TABLE, TABLE.drop_columns(["hit"])) == ["hit"]
    assert differing(TABLE, TABLE.select(list(COLUMNS)[::-1])) == ["the order of columns"]
