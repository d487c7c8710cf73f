"""The studio in the browser: the stage, trials, the editor, the whole journey."""
