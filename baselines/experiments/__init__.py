"""Experiments that are run as a whole: the paper's, surveys, ablations."""
