"""This package has what HAVs have to do with obstacles: collisions, nearest points, rays."""
