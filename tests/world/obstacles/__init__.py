"""This package tests obstacles of worlds: collisions with them, nearest points, rays."""
