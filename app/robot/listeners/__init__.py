"""From landmarks to recognitions: between salutes, without salutes, and as phrases."""
