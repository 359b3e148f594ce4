"""This package has the units of HAVs: their hitches and the shapes of their bodies."""
