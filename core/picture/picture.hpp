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

/// A mesh as VTK's; single precision.
vtkSmartPointer<vtkPolyData> vtk_triangles(const TriangleMesh& mesh);

/// White ground, a key light over the left shoulder and a soft one from the other side, so that facets show.
vtkSmartPointer<vtkRenderer> lit_renderer();

/// Turns the renderer's camera so that the ball of the view just fills a picture of 4:3, or `zoom` times that.
void set_camera(vtkRenderer* renderer, const View& view, double zoom = 1);

/// A picture in memory.
struct Image {
  int width = 0, height = 0;
  std::vector<unsigned char> rgb;  ///< rows from the top, three bytes a pixel
};

/// Draws the renderers, each in its own viewport of one picture, with smooth edges.
/// Call display_obstacle first: VTK aborts without a display.
Image draw_image(const std::vector<vtkRenderer*>& renderers, int width, int height);

/// Fails: SystemError when the file cannot be written.
void write_png(const Image& image, const std::string& path);

/// Draws them into a PNG. Fails: SystemError when the file cannot be written.
void write_picture(const std::vector<vtkRenderer*>& renderers, int width, int height, const std::string& path);

}  // namespace scree
