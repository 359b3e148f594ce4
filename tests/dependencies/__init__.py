"""This package tests the lowest and the newest dependencies."""
