"""This package tests the policies of the baselines but Reserve."""
