"""Why a recognition came out as it did: differences, alignments, counterfactuals."""
