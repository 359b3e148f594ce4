"""This package tests experiments: the reproduction of the paper, surveys, ablations."""
