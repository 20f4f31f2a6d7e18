"""[[feeds]] and [[exits]]: where grains enter and leave during a run."""
