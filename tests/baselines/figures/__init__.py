"""This package tests the figures of evaluations."""
