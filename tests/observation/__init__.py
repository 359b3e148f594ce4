"""This package tests the rows that learners observe."""
