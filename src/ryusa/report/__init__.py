"""The ledger of the paper's claims: what each says, what came out, the verdict; as JSON and as one page."""

from ryusa.report.ledger import Ledger, Row, make
from ryusa.report.page import write

__all__ = ["Ledger", "Row", "make", "write"]
