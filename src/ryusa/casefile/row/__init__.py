"""[water.row]: columns of water in a row along the stream."""
