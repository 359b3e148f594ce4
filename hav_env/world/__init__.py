"""This package holds the worlds: arrays, events, collisions, and what HAVs sense of each other."""
