"""DOLFINx opens a .msh file of ours, and says what is in it:

    sudo apt install python3-dolfinx python3-gmsh
    python3 dolfinx_reads.py plate.msh

It asserts that every point is in a triangle. It has the numbers of groups; their names are Gmsh's to tell.
"""

import sys


def main(path):
    import gmsh
    import numpy as np
    from dolfinx.io import gmshio
    from mpi4py import MPI

    gmsh.initialize(["", "-v", "1"])
    gmsh.open(path)
    names = {group: gmsh.model.getPhysicalName(*group) for group in gmsh.model.getPhysicalGroups()}
    mesh, cells, facets = gmshio.model_to_mesh(gmsh.model, MPI.COMM_SELF, 0, gdim=2)
    gmsh.finalize()
    print(f"{len(mesh.geometry.x)} points, {mesh.topology.index_map(2).size_local} triangles")
    for dimension, tags in ((2, cells), (1, facets)):
        for number in np.unique(tags.values):
            print(f"{names[dimension, number]}: {np.count_nonzero(tags.values == number)}")


if __name__ == "__main__":
    main(sys.argv[1])
