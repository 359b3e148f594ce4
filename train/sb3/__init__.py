"""PPO on Stable-Baselines3: its callback, checkpoints and warm starts."""
