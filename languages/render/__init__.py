"""Renderer of the sample clips: a computer-generated diver performs the paper's gestures.

No person was filmed. The app and its tests need neither this package nor what it depends on.
"""
