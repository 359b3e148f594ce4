"""This package runs whole experiments: the paper's, surveys, calibrations and ablations."""
