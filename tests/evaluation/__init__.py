"""This package tests rollouts, tables of episodes and statistics."""
