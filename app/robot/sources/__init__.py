"""Where a robot gets frames from: cameras, streams, clips and recorded bags."""
