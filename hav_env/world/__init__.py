"""This package holds the worlds: arrays, events, collisions, and how HAVs sense each other."""
