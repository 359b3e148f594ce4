"""This package holds what tests share."""
