"""This package has the units of HAVs: where they are hitched, what shape their bodies have."""
