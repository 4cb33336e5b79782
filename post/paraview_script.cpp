// The text of open_in_paraview.py. It needs nothing but ParaView 5.11 or newer.
#include <fmt/format.h>

#include "post/drawn_meshes.hpp"
#include "post/paraview.hpp"

namespace scree {

namespace {

/// A text as a Python literal (JSON strings are Python strings).
std::string quoted(const std::string& text) { return nlohmann::json(text).dump(); }

constexpr const char* kBody = R"PY(

def own_folder():
    """The folder of this script: `paraview --script` does not always say where it found it."""
    candidates = []
    if "__file__" in globals():
        candidates.append(os.path.dirname(os.path.abspath(__file__)))
    for word in getattr(sys, "argv", []):
        if word.startswith("--script="):
            word = word[len("--script="):]
        if word.endswith(".py"):
            candidates.append(os.path.dirname(os.path.abspath(word)))
    candidates += [os.getcwd(), FOLDER_WHEN_WRITTEN]
    for folder in candidates:
        if os.path.exists(os.path.join(folder, "shape_0.vtp")) and os.path.exists(os.path.join(folder, "open_in_paraview.py")):
            return folder
    raise SystemExit("open_in_paraview.py: cannot find shape_0.vtp; start ParaView in the folder of this script")


def colour_by_shape(display, association):
    ColorBy(display, (association, "shape"))
    table = GetColorTransferFunction("shape")
    table.InterpretValuesAsCategories = 1
    table.Annotations = [text for k, name in enumerate(SHAPES) for text in (str(k), name)]
    table.IndexedColors = [c for colour in COLOURS for c in colour]


def show_glyphs(here, view):
    """Every body as its true shape: one copy of each mesh, drawn once per body by the graphics card."""
    reader = OpenDataFile(os.path.join(here, RUN, "frames.hdf.series"))
    RenameSource("bodies", reader)
    meshes = []
    for k, name in enumerate(SHAPES):
        mesh = XMLPolyDataReader(FileName=[os.path.join(here, "shape_%d.vtp" % k)])
        RenameSource("shape %d: %s" % (k, name), mesh)
        meshes.append(mesh)
    table = GroupDatasets(Input=meshes)
    RenameSource("shapes", table)
    for source in meshes + [table]:
        Hide(source, view)
    display = Show(reader, view)
    display.Representation = "3D Glyphs"
    display.GlyphType = "Pipeline Connection"
    display.GlyphType.Input = table
    display.Orient = 1
    display.OrientationMode = "Quaternion"
    display.SelectOrientationVectors = "quat"
    display.Scaling = 1
    display.ScaleMode = "Magnitude"
    display.SelectScaleArray = "scale"
    display.ScaleFactor = 1.0
    display.UseGlyphTable = 1
    display.UseCompositeGlyphTable = 1
    display.GlyphTableIndexArray = "shape"
    colour_by_shape(display, "POINTS")
    return reader, display


def show_surfaces(here, view):
    """Every body as its own triangles, from frame_*.vtp: larger files, but any filter works on them."""
    reader = OpenDataFile(os.path.join(here, NAME + ".pvd"))
    RenameSource("surfaces", reader)
    display = Show(reader, view)
    display.Representation = "Surface"
    colour_by_shape(display, "CELLS")
    return reader, display


def show_walls(here, view):
    path = os.path.join(here, "walls.pvd")
    if not os.path.exists(path):
        path = os.path.join(here, "walls.vtp")
    if not os.path.exists(path):
        return None
    walls = OpenDataFile(path)
    RenameSource("walls", walls)
    display = Show(walls, view)
    display.Representation = "Surface"
    edges = FeatureEdges(Input=walls)
    RenameSource("wall edges", edges)
    lines = Show(edges, view)
    for item, opacity in ((display, 0.10), (lines, 1.0)):
        item.ColorArrayName = [None, ""]
        item.AmbientColor = item.DiffuseColor = [0.45, 0.52, 0.60]
        item.Opacity = opacity
    return walls


def main():
    parser = argparse.ArgumentParser(prog="open_in_paraview.py", description="Shows a Scree run with true particle shapes.")
    parser.add_argument("--picture", help="save a PNG and leave")
    parser.add_argument("--frame", type=int, default=-1, help="which frame to show, from 0; -1 is the last")
    parser.add_argument("--surfaces", action="store_true", help="show the expanded surfaces instead of glyphs")
    parser.add_argument("--plain", action="store_true", help="bodies only: no walls, no time, no legend")
    parser.add_argument("--size", type=int, nargs=2, default=[1280, 960], metavar=("W", "H"))
    options = parser.parse_known_args(getattr(sys, "argv", [])[1:])[0]

    here = own_folder()
    paraview.simple._DisableFirstRenderCameraReset()
    view = GetActiveViewOrCreate("RenderView")
    view.UseColorPaletteForBackground = 0
    view.Background = [1.0, 1.0, 1.0]
    view.OrientationAxesVisibility = 0 if options.plain else 1
    if options.picture:
        view.ViewSize = options.size
    reader, display = (show_surfaces if options.surfaces else show_glyphs)(here, view)

    scene = GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    times = list(getattr(reader, "TimestepValues", []) or [0.0])
    scene.AnimationTime = times[options.frame if -len(times) <= options.frame < len(times) else -1]

    if not options.plain:
        show_walls(here, view)
        annotation = AnnotateTimeFilter(Input=reader)
        annotation.Format = "t = {time:.4f} s"
        label = Show(annotation, view)
        label.Color = [0.1, 0.1, 0.1]
        label.FontSize = 22
        if len(SHAPES) > 1:
            display.SetScalarBarVisibility(view, True)
            bar = GetScalarBar(GetColorTransferFunction("shape"), view)
            bar.Title = "shape"
            bar.ComponentTitle = ""
            bar.TitleColor = [0.1, 0.1, 0.1]
            bar.LabelColor = [0.1, 0.1, 0.1]
    view.CameraFocalPoint = CENTRE
    view.CameraPosition = [c + 3.4 * RADIUS * d for c, d in zip(CENTRE, FROM)]
    view.CameraViewUp = UP
    view.CameraViewAngle = 30.0
    view.CenterOfRotation = CENTRE
    Render(view)
    if options.picture:
        SaveScreenshot(options.picture, view, ImageResolution=options.size)


main()
)PY";

}  // namespace

std::string paraview_script(const Run& run, const std::string& run_from_script, const std::string& script_folder) {
  const auto list = [](const Vec3& v) { return fmt::format("[{}, {}, {}]", v.x, v.y, v.z); };
  std::string shapes, colours;
  for (std::size_t k = 0; k < run.scene.shapes.size(); ++k) {
    const char* const comma = k > 0 ? ", " : "";
    shapes += fmt::format("{}{}", comma, quoted(run.scene.shapes[k].name));
    colours += fmt::format("{}{}", comma, list(shape_colour(static_cast<std::int32_t>(k))));
  }
  // Everything that is drawn at the first and at the last frame is in view.
  Box3 room = room_of(load_frame(run, 0).bodies, run.scene);
  room.add(room_of(load_frame(run, run.frames.size() - 1).bodies, run.scene));
  const Vec3 gravity = run.scene.settings.gravity;
  const View view = view_of(room, gravity);

  std::string text =
      "# Opens this run in ParaView 5.11 or newer with every body in its true shape. Written by scree-post.\n"
      "#\n"
      "#   paraview --script=open_in_paraview.py                          look at it\n"
      "#   pvbatch open_in_paraview.py --picture rocks.png --frame 10     a picture, without a window\n"
      "#\n"
      "# More frames may be added to the run later: they are found through its frames.hdf.series.\n"
      "import argparse\nimport os\nimport sys\n\nimport paraview.simple\nfrom paraview.simple import *\n\n";
  text += fmt::format("NAME = {}\n", quoted(run.name));
  text += fmt::format("RUN = {}  # the run folder, seen from the folder of this script\n", quoted(run_from_script));
  text += fmt::format("FOLDER_WHEN_WRITTEN = {}  # used only when nothing else tells where the script is\n", quoted(script_folder));
  text += fmt::format("SHAPES = [{}]\n", shapes);
  text += fmt::format("COLOURS = [{}]\n", colours);
  text += fmt::format("CENTRE, RADIUS = {}, {}  # of what is drawn [m]\n", list(view.centre), view.radius);
  text += fmt::format("FROM, UP = {}, {}  # direction to the camera; against gravity\n", list(view.from), list(view.up));
  return text + kBody;
}

}  // namespace scree
