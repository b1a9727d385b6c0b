"""Universal Robots UR5e, 6 joints: written by gen-model; do not edit."""
