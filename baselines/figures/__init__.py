"""This package draws figures of evaluations and of the paper."""
