"""Other ways to name what is missing, to stand beside `residuum explain` on the same cases."""
