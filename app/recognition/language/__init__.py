"""Language: gesture languages, their file format and conversions to other formats."""
