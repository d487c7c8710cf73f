"""Triggers: what begins and ends a take: a salute, a held pose of the arms, or nothing."""
