// Compiled as C++17: vtkSMPTools.h of VTK 9.1 is not C++20 (a template-id names a constructor).
#include "post/vtk/vtk_threads.hpp"

#include <vtkSMPTools.h>

#include <cstring>

namespace scree {

void keep_vtk_to_one_thread() { vtkSMPTools::SetBackend("Sequential"); }
bool vtk_has_threads() { return std::strcmp(vtkSMPTools::GetBackend(), "Sequential") != 0; }

}  // namespace scree
