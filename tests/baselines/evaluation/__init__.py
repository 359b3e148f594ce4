"""This package tests evaluations that are kept on disk."""
