"""Decision: from voters' distances to a label, by fusion, votes, thresholds and rejection."""
