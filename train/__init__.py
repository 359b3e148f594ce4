"""This package trains policies by PPO, and compares trained policies with scripted ones."""
