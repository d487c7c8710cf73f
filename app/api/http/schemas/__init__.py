"""Request and response bodies as pydantic models, by noun; `/openapi.json` is made from them."""
