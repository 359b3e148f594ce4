"""This package tests the command line of the baselines."""
