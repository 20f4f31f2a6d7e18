"""What every engine shares: layout, parameters, contact memory and records, energy account, refusals."""
