"""Training of policies, and their comparison."""
