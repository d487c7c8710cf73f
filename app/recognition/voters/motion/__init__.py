"""Motion voters: compare movements by path, posture, order of steps and time."""
