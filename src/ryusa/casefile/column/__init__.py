"""[water.column]: a column of water that exchanges momentum with the grains."""
