"""This package computes without the simulator: Dubins paths, geometry, outlines, random numbers."""
