"""Many runs of one case: sweeps, calibration, and how soft a case may be."""
