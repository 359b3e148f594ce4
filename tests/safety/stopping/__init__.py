"""Tests of hav_env/safety/stopping."""
