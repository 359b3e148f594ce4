"""This package tests the decision process: actions, rewards, ends, reports."""
