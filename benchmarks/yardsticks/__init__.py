"""This package measures programs that do the same work by other means, to compare with."""
