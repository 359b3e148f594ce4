"""This package trains by PPO on Stable-Baselines3: callback, checkpoints, warm starts."""
