"""Recorded episodes, and how they are watched."""
