"""This package finds models by name and checks their fields: kinds, ranges, memory."""
