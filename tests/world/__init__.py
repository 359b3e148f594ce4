"""This package tests the events in a world: collisions, goals, sensing."""
