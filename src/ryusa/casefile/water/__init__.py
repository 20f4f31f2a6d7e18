"""[water]: velocity profile, drag, added mass and torque."""
