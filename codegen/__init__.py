"""SymPy expression lists become C, NumPy and URScript text through one instruction listing."""
