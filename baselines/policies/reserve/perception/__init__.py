"""This package writes what a HAV under Reserve senses and receives into its memory."""
