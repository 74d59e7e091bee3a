from .action import AsyncActionServer

__all__ = ["AsyncActionServer"]
