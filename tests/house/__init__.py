"""This package tests the layout of the project."""
