"""This package tests training."""
