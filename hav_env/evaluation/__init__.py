"""Evaluation of policies: episodes, the table of them, figures and their comparison."""
