"""This package has the interaction of HAVs with obstacles: collisions, nearest points, rays."""
