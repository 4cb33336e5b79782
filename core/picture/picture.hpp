// Pictures drawn without a window: camera, light and file, for the tools that have something to show.
#pragma once

#include <vtkPolyData.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <string>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"
#include "core/picture/view.hpp"

namespace scree {

/// Why a picture cannot be drawn here and what to do, or "" when it can. Debian's VTK draws through X only.
/// in   tool   for the advice: "scree-post"
std::string why_no_picture(const std::string& tool);

/// A mesh as VTK's; single precision.
vtkSmartPointer<vtkPolyData> vtk_triangles(const TriangleMesh& mesh);

/// White ground, a key light over the left shoulder and a soft one from the other side, so that facets show.
vtkSmartPointer<vtkRenderer> lit_renderer();

/// Turns the renderer's camera so that the ball of the view just fills a picture of 4:3, or `zoom` times that.
void set_camera(vtkRenderer* renderer, const View& view, double zoom = 1);

/// Draws the renderers, each in its own viewport of one picture, into a PNG, with smooth edges.
/// Fails: SystemError when the file cannot be written. Call why_no_picture first: VTK aborts without a display.
void write_picture(const std::vector<vtkRenderer*>& renderers, int width, int height, const std::string& path);

}  // namespace scree
