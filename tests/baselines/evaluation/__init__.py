"""This package tests evaluations that are stored on disk."""
