"""What fem_mesh raises when it is given something it cannot mesh."""


class MeshError(ValueError):
    """Input or a mesh that is wrong: the message says what, where (indices, coordinates) and what to do."""
