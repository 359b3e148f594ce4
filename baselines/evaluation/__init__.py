"""This package runs evaluations of policies on disk, in parts, on one machine or a Ray cluster."""
