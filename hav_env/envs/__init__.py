"""This package has the environments for PettingZoo, Gymnasium and Stable-Baselines3."""
