"""Decision: from voters' distances to a label, by fusion, votes, rejection and asking back."""
