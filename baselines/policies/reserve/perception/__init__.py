"""This package writes what a HAV under Reserve senses and hears into its memory."""
