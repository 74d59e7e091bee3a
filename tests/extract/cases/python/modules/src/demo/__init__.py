from .core import Core
