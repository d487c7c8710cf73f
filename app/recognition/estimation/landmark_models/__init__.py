"""The neural networks that find bodies and hands in a picture, and what surrounds them."""
