"""Hand finder: renders divers' hands, and teaches MediaPipe's palm detector to find them."""
