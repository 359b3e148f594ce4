"""This package has the arrays of the place in which the HAVs of a world drive."""
