"""This module writes tables of figures: rows and columns from keys, numbers as text."""

from rich.table import Table


def by_row(rates: dict[tuple[str, str], float]) -> dict[str, dict[str, float]]:
    """Convert (row, column) -> rate to row -> column -> rate."""
    rows: dict[str, dict[str, float]] = {}
    for (row, column), rate in rates.items():
        rows.setdefault(row, {})[column] = rate
    return rows


def new_table(title: str, first: str, *columns: str) -> Table:
    """Return a table whose columns hold numbers, except the first one."""
    table = Table(title=title)
    table.add_column(first)
    for column in columns:
        table.add_column(column, justify="right")
    return table


def rate_text(value: float | None) -> str:
    """Return a rate as text; empty if there is none."""
    return "" if value is None else f"{value:,.0f}"


def ratio_text(one: float | None, other: float | None) -> str:
    """Return the ratio of two rates as text; empty if one is missing."""
    return f"{one / other:.2f}" if one and other else ""
