"""This package tests the policy Reserve."""
