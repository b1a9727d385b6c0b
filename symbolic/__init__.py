"""SymPy only: frames, energies, equations of motion, friction and drive terms."""
