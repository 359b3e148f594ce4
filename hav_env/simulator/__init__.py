"""This package steps batches of worlds: motion, sensing, collisions, goals."""
