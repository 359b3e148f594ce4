"""This package tests drawings, windows and the viewer."""
