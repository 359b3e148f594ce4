"""This package tests what happens in a world: collisions, goals, events, sensing."""
