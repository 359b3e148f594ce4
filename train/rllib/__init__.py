"""PPO on Ray RLlib."""
