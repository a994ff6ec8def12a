// deal.II opens a .msh file of ours, and says what is in it:
//
//     sudo apt install libdeal.ii-dev cmake g++
//     cmake . && make && ./dealii_reads plate.msh
//
// It takes no lines inside the mesh, so no interfaces and no cracks.
#include <deal.II/grid/grid_in.h>
#include <deal.II/grid/tria.h>

#include <iostream>
#include <map>

int main(int, char **argv)
{
  dealii::Triangulation<2> mesh;
  dealii::GridIn<2>(mesh).read(argv[1]);
  std::map<int, int> materials, boundaries;
  for (const auto &cell : mesh.active_cell_iterators()) {
    ++materials[cell->material_id()];
    for (const auto &face : cell->face_iterators())
      if (face->at_boundary())
        ++boundaries[face->boundary_id()];
  }
  std::cout << mesh.n_used_vertices() << " points, " << mesh.n_active_cells() << " triangles\n";
  for (const auto &[id, count] : materials)
    std::cout << "material " << id << ": " << count << '\n';
  for (const auto &[id, count] : boundaries)
    std::cout << "boundary " << id << ": " << count << '\n';
}
