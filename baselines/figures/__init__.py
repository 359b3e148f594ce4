"""Figures of evaluations and of the paper."""
