"""Router of recognitions."""
