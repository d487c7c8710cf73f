"""MAVLink bridge: gives a vehicle the commands that a diver has confirmed."""
