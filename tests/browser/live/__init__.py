"""The live view in the browser: streams and cameras."""
