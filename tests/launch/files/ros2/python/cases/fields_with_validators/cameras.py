from typing import List, Optional

from pydantic import BaseModel, root_validator


class Camera(BaseModel):
    name: str = "camera"
    remappings: Optional[List]
    namespace: Optional[str]

    @root_validator
    def fill(cls, values):
        if not values.get("remappings"):
            values["remappings"] = [("image_raw", f"{values['name']}/image_raw")]
        return values


class Opaque(BaseModel):
    name: str

    @root_validator
    def fill(cls, values):
        return elsewhere(values)
