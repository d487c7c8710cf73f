"""Publishers: send recognitions to other programs in the network."""
