"""This package tests learners of other projects: Ray, TorchRL, Minari."""
