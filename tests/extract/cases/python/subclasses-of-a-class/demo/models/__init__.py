from .model import Model
from .linear import Linear
from .plain import Plain
