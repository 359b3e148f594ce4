"""This package tests the mathematics: Dubins paths, geometry, elementary functions."""
