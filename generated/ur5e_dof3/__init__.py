"""Universal Robots UR5e, 3 joints: written by gen-model; do not edit."""
