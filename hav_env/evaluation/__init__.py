"""This package evaluates policies: episodes, their table, figures, comparisons, statistics."""
