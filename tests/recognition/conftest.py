"""How property tests run here: enough examples to find a broken law, few enough to stay quick."""

from hypothesis import settings

# No deadline: an example takes milliseconds, but the machine may be busy with something else.
settings.register_profile("recognition", max_examples=25, deadline=None)
settings.load_profile("recognition")
