"""What every table of a case file has in common: frozen once read, and an unknown key is an error."""

from pydantic import BaseModel, ConfigDict


class Section(BaseModel):
    """A table of the case file."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", populate_by_name=True, use_attribute_docstrings=True
    )


def given(section: BaseModel, key: str) -> bool:
    """Whether the case file itself sets a key, so that its value is not a default."""
    return key in section.model_fields_set and getattr(section, key) is not None
