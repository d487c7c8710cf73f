"""Published sets of divers' signs, read in the layout in which their authors give them."""
