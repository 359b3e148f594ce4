"""This package tests the baselines."""
