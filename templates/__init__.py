"""Jinja templates; the tree mirrors the output tree of gen-model."""
