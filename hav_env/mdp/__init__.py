"""This package is the decision process: actions, observations, rewards, ends and reports."""
