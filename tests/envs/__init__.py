"""This package tests the environments for PettingZoo, Gymnasium and Stable-Baselines3."""
