// Our meshes as VTK's: for files and for pictures.
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include "post/run/bonds_in_frame.hpp"
#include "post/run/drawn_meshes.hpp"
#include "post/run/wall_loads.hpp"

namespace scree {

vtkSmartPointer<vtkPolyData> vtk_mesh(const DrawnMesh& mesh);
/// All walls placed in the world; cell data "wall" is the wall's id, and those of `loads` have their names (kLoadQuantities).
vtkSmartPointer<vtkPolyData> vtk_walls(const Scene& scene, const std::vector<TriangleMesh>& walls, const std::vector<WallPlace>& places,
                                       const std::vector<WallLoads>& loads = {});

/// Faces of bonds; cell data body_a, body_b, energy and those of kBondQuantities.
vtkSmartPointer<vtkPolyData> vtk_bonds(const std::vector<BondFace>& faces);

/// The twelve edges of a periodic cell as lines: of all cells with its images the one that is sheared least.
vtkSmartPointer<vtkPolyData> vtk_cell(const FrameCell& cell, const Periodicity& period);

}  // namespace scree
