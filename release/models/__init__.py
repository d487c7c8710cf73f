"""Models of a release: MediaPipe's, taken from its wheel and converted to ONNX."""
