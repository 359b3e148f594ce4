"""This package trains by PPO on Ray RLlib."""
