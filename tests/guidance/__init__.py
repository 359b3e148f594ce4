"""This package tests guidance: lattices, what they keep clear of, and how trucks follow them."""
