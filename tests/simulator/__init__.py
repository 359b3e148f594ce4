"""This package tests batches of worlds: episodes, determinism, steps."""
