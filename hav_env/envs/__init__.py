"""Environments: faces of the decision process for PettingZoo, Gymnasium, Stable-Baselines3."""
