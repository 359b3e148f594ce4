"""This package tests the documentation."""
