"""This package measures environments through the interfaces that users call."""
