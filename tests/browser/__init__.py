"""This package tests the replay page in a browser."""
