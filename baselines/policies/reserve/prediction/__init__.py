"""This package predicts paths, steps and circles of a HAV under Reserve."""
