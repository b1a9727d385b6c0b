"""Checked-in output of gen-model; it imports NumPy alone and is never edited."""
