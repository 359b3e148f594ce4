"""This package trains policies, and compares them."""
