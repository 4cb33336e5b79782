// The text of open_in_paraview.py. It needs nothing but ParaView 5.11 or newer.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>

#include "core/base/utf8.hpp"
#include "post/run/bonds_in_frame.hpp"
#include "post/run/drawn_meshes.hpp"
#include "post/run/wall_loads.hpp"
#include "post/vtk/paraview.hpp"

namespace scree {

namespace {

/// A text as a Python literal (JSON strings are Python strings).
std::string quoted(const std::string& text) { return nlohmann::json(printable(text)).dump(); }

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


def colour_by(display, what, association):
    """Shapes, materials and ranks are names; speed is a scale that the colour-blind can read and that prints in grey."""
    if what == "velocity":
        ColorBy(display, (association, "velocity", "Magnitude"))
        table = GetColorTransferFunction("velocity")
        table.ApplyPreset("Viridis (matplotlib)", True)
        display.RescaleTransferFunctionToDataRange(True, False)
        return table, "speed [m/s]"
    ColorBy(display, (association, what))
    table = GetColorTransferFunction(what)
    table.InterpretValuesAsCategories = 1
    if what == "fragment":   # the lowest id of its bodies; those without bonds are -1
        table.Annotations = [text for k in [-1] + BONDED for text in (str(k), "without bonds" if k < 0 else "fragment %d" % k)]
        table.IndexedColors = [0.6, 0.6, 0.6] + [c for k in range(len(BONDED)) for c in COLOURS[k % len(COLOURS)]]
        return table, what
    names = {"shape": SHAPES, "material": MATERIALS}.get(what) or ["rank %d" % k for k in range(RANKS)]
    colours = [COLOURS[k % len(COLOURS)] for k in range(len(names))]
    shown = {"shape": SHAPES_OF_BODIES, "material": MATERIALS_OF_BODIES}.get(what) or range(len(names))   # those of walls alone are left out
    table.Annotations = [text for k in shown for text in (str(k), names[k])]
    table.IndexedColors = [c for k in shown for c in colours[k]]
    return table, what


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
    return reader, display, "POINTS"


def show_surfaces(here, view):
    """Every body as its own triangles, from frame_*.vtp: larger files, but any filter works on them."""
    reader = OpenDataFile(os.path.join(here, NAME + ".pvd"))
    RenameSource("surfaces", reader)
    display = Show(reader, view)
    display.Representation = "Surface"
    return reader, display, "CELLS"


def as_glass(display, opacity):
    display.Representation = "Surface"
    display.ColorArrayName = [None, ""]
    display.AmbientColor = display.DiffuseColor = [0.45, 0.52, 0.60]
    display.Opacity = opacity


def show_loads(walls, view, what):
    """Walls with load maps coloured by a quantity, the mean since the frame before; the others stay glass, and bodies are out of the way."""
    Hide(walls, view)
    parts = []
    for name, low in (("walls with load maps", 0.5), ("other walls", -0.5)):
        part = Threshold(Input=walls)
        RenameSource(name, part)
        part.Scalars = ["CELLS", "has_load_map"]
        part.LowerThreshold, part.UpperThreshold = low, low + 1
        parts.append(part)
    mapped, others = parts
    as_glass(Show(others, view), 0.10)
    display = Show(mapped, view)
    display.Representation = "Surface"
    ColorBy(display, ("CELLS", what))
    table = GetColorTransferFunction(what)
    table.ApplyPreset("Viridis (matplotlib)", True)
    values = servermanager.Fetch(mapped).GetCellData().GetArray(what)
    borne = sorted(v for v in (values.GetValue(k) for k in range(values.GetNumberOfTuples())) if v > 0)
    if borne:
        table.RescaleTransferFunction(0.0, borne[int(0.99 * (len(borne) - 1))])   # a scale that one triangle does not set
    return table, LOADS[what], display


def taken_apart(source, share):
    """Fragments moved from the middle of their body by a share of their way."""
    warp = WarpByVector(Input=source)
    warp.Vectors = ["POINTS", "apart"]
    warp.ScaleFactor = share
    RenameSource("fragments apart", warp)
    return warp


def show_bonds(here, view, share):
    """Faces of the bonds that hold, as rectangles smaller than they are: else those of many cells are one wall."""
    bonds = OpenDataFile(os.path.join(here, "bonds.pvd"))
    RenameSource("bonds", bonds)
    Hide(bonds, view)
    faces = Shrink(Input=taken_apart(bonds, share) if share > 0 else bonds)
    faces.ShrinkFactor = 0.6
    RenameSource("faces of bonds", faces)
    return faces, Show(faces, view)


def colour_bonds(faces, display, what):
    """By what they bear, on a scale that one face in a hundred exceeds. Along the normal it has two signs: tension red, pressure blue, and white in the middle."""
    display.Representation = "Surface"
    ColorBy(display, ("CELLS", what))
    table = GetColorTransferFunction(what)
    signed = what == "normal_stress"
    table.ApplyPreset("Cool to Warm" if signed else "Viridis (matplotlib)", True)
    values = servermanager.Fetch(faces).GetCellData().GetArray(what)
    sizes = sorted(abs(values.GetValue(k)) for k in range(values.GetNumberOfTuples()))
    end = sizes[int(0.99 * (len(sizes) - 1))] or 1.0
    table.RescaleTransferFunction(-end if signed else 0.0, end)
    return table, BONDS[what], display


def show_walls(here, view):
    path = os.path.join(here, "walls.pvd")
    if not os.path.exists(path):
        path = os.path.join(here, "walls.vtp")
    if not os.path.exists(path):
        return None
    walls = OpenDataFile(path)
    RenameSource("walls", walls)
    as_glass(Show(walls, view), 0.10)
    edges = FeatureEdges(Input=walls)
    RenameSource("wall edges", edges)
    as_glass(Show(edges, view), 1.0)
    return walls


def show_cell(here, view):
    """Edges of the periodic cell."""
    cell = OpenDataFile(os.path.join(here, "cell.pvd"))
    RenameSource("periodic cell", cell)
    display = Show(cell, view)
    as_glass(display, 1.0)
    display.LineWidth = 2.0


def show_network(here, view):
    """Contacts as tubes from centre to centre; radius and colour by normal force."""
    network = OpenDataFile(os.path.join(here, "network.pvd"))
    RenameSource("contact network", network)
    Hide(network, view)
    tubes = Tube(Input=network)
    RenameSource("contact forces", tubes)
    tubes.Scalars = ["POINTS", "normal_force"]
    tubes.VaryRadius = "By Scalar"
    tubes.Radius = 0.02 * SIZE  # of the weakest contact
    tubes.RadiusFactor = 8.0    # the strongest is that much thicker
    tubes.NumberofSides = 8
    display = Show(tubes, view)
    return network, tubes, display


def main():
    parser = argparse.ArgumentParser(prog="open_in_paraview.py", description="Shows a Scree run with true particle shapes.")
    parser.add_argument("--picture", help="save a PNG and leave")
    parser.add_argument("--frame", type=int, default=-1, help="which frame to show, from 0; -1 is the last")
    parser.add_argument("--surfaces", action="store_true", help="show the expanded surfaces instead of glyphs")
    parser.add_argument("--colour", choices=["shape", "velocity", "rank", "material", "fragment"], default="shape",
                        help="of the bodies (default shape); fragment: what bonds hold together")
    parser.add_argument("--network", action="store_true", help="show the contact network as tubes, and the bodies translucent")
    parser.add_argument("--bonds", choices=sorted(BONDS), help="show the faces of the bonds that hold by what they bear, and the bodies translucent")
    parser.add_argument("--apart", type=float, default=0.0, help="fragments moved from the middle of their body by this share of their way")
    parser.add_argument("--load", choices=sorted(LOADS), help="colour the walls by what their load maps say, without the bodies")
    parser.add_argument("--plain", action="store_true", help="bodies only: no walls, no time, no legend")
    parser.add_argument("--size", type=int, nargs=2, default=[1280, 960], metavar=("W", "H"))
    options = parser.parse_known_args(getattr(sys, "argv", [])[1:])[0]

    here = own_folder()
    if options.network and not os.path.exists(os.path.join(here, "network.pvd")):  # before there is a view: ParaView does not survive an exit with one
        raise SystemExit("open_in_paraview.py: no network.pvd beside it; the run kept no contacts (contacts = true in [output] of the case)")
    if (options.bonds or options.apart > 0 or options.colour == "fragment") and not BONDED:
        raise SystemExit("open_in_paraview.py: this run has no bonds")
    surfaces = options.surfaces or options.apart > 0 or options.colour == "fragment"   # glyphs know nothing of fragments
    if surfaces and not os.path.exists(os.path.join(here, NAME + ".pvd")):
        raise SystemExit("open_in_paraview.py: no %s.pvd beside it; write the surfaces with scree-post paraview --surfaces all" % NAME)
    paraview.simple._DisableFirstRenderCameraReset()
    view = GetActiveViewOrCreate("RenderView")
    view.UseColorPaletteForBackground = 0
    view.Background = [1.0, 1.0, 1.0]
    view.OrientationAxesVisibility = 0 if options.plain else 1
    view.OrientationAxesLabelColor = [0.1, 0.1, 0.1]
    if options.picture:
        view.ViewSize = options.size
    reader, display, association = (show_surfaces if surfaces else show_glyphs)(here, view)

    scene = GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    times = list(getattr(reader, "TimestepValues", []) or [0.0])
    scene.AnimationTime = times[options.frame if -len(times) <= options.frame < len(times) else -1]

    if options.apart > 0:
        whole, reader = reader, taken_apart(reader, options.apart)
        Hide(whole, view)
        display = Show(reader, view)
        display.Representation = "Surface"

    Render(view)  # data ranges are known from here on
    legend = None
    if options.network:
        network, tubes, tube_display = show_network(here, view)
        network.UpdatePipeline(scene.AnimationTime)
        if network.GetDataInformation().GetNumberOfCells() == 0:
            Hide(tubes, view)  # nothing touches in this frame
        else:
            tubes.UpdatePipeline(scene.AnimationTime)
            ColorBy(tube_display, ("POINTS", "normal_force"))
            legend = GetColorTransferFunction("normal_force"), "normal force [N]", tube_display
            legend[0].ApplyPreset("Viridis (matplotlib)", True)
            tube_display.RescaleTransferFunctionToDataRange(True, False)
        display.ColorArrayName = [None, ""]
        display.AmbientColor = display.DiffuseColor = [0.60, 0.62, 0.65]
        display.Opacity = 0.12
    elif options.bonds:
        bonds, bond_display = show_bonds(here, view, options.apart)
        bonds.UpdatePipeline(scene.AnimationTime)
        if bonds.GetDataInformation().GetNumberOfCells() == 0:
            Hide(bonds, view)  # none holds in this frame
        else:
            legend = colour_bonds(bonds, bond_display, options.bonds)
        display.ColorArrayName = [None, ""]
        display.AmbientColor = display.DiffuseColor = [0.60, 0.62, 0.65]
        display.Opacity = 0.12
    else:
        table, title = colour_by(display, options.colour, association)
        if (len(SHAPES_OF_BODIES) > 1 or options.colour != "shape") and options.colour != "fragment":   # a legend of all pieces would cover the picture
            legend = table, title, display

    if options.load:
        if not HAS_LOADS:
            raise SystemExit("open_in_paraview.py: no wall of this run has a load map (load_map = true in [[walls]] of the case)")
        walls = show_walls(here, view)
        walls.UpdatePipeline(scene.AnimationTime)
        legend = show_loads(walls, view, options.load)
        Hide(reader, view)
    if not options.plain:
        if not options.load:
            show_walls(here, view)
        if os.path.exists(os.path.join(here, "cell.pvd")):
            show_cell(here, view)
        annotation = AnnotateTimeFilter(Input=reader)
        annotation.Format = "t = {time:.4f} s"
        label = Show(annotation, view)
        label.WindowLocation = "Upper Left Corner"
        label.Color = [0.1, 0.1, 0.1]
        label.FontSize = 22
        if legend:
            legend[2].SetScalarBarVisibility(view, True)
            bar = GetScalarBar(legend[0], view)
            bar.Title = legend[1]
            bar.ComponentTitle = ""
            bar.RangeLabelFormat = "%.3g"
            bar.WindowLocation = "Lower Right Corner"
            bar.ScalarBarLength = 0.3
            bar.TitleColor = [0.1, 0.1, 0.1]
            bar.LabelColor = [0.1, 0.1, 0.1]
    view.CameraFocalPoint = CENTRE
    view.CameraPosition = [c + 3.9 * RADIUS * d for c, d in zip(CENTRE, FROM)]
    view.CameraViewUp = UP
    view.CameraViewAngle = 30.0
    view.CenterOfRotation = CENTRE
    Render(view)
    if options.picture:
        SaveScreenshot(options.picture, view, ImageResolution=options.size)


main()
)PY";

}  // namespace

std::string paraview_script(const Run& run, const std::string& run_from_script, const std::string& script_folder,
                            const BodyExtent& extent) {
  const auto list = [](const Vec3& v) { return fmt::format("[{}, {}, {}]", v.x, v.y, v.z); };
  std::string shapes, materials, colours;
  for (std::size_t k = 0; k < run.scene.shapes.size(); ++k) {
    const char* const comma = k > 0 ? ", " : "";
    shapes += fmt::format("{}{}", comma, quoted(run.scene.shapes[k].name));
  }
  for (std::size_t k = 0; k < run.scene.materials.size(); ++k) materials += (k > 0 ? ", " : "") + quoted(run.scene.materials[k].name);
  for (std::int32_t k = 0; k < kShapeColours; ++k) colours += (k > 0 ? ", " : "") + list(shape_colour(k));
  // the mean over all bodies that the run has or had
  const RunBodies bodies(run);
  double size = 0;
  for (const RunBody& body : bodies.all) {
    size +=
        body.scale * run.scene.shapes[static_cast<std::size_t>(body.shape)].equivalent_diameter() / static_cast<double>(bodies.all.size());
  }
  const std::vector<std::int32_t> shapes_now = bodies.shapes(), materials_now = bodies.materials();
  std::set<std::int32_t> body_shapes(shapes_now.begin(), shapes_now.end());
  std::set<std::int32_t> body_materials(materials_now.begin(), materials_now.end());
  for (const Inlet& inlet : run.scene.inlets) {
    for (const auto& share : inlet.shares) body_shapes.insert(share.shape);
    body_materials.insert(inlet.material);
  }
  const Box3 room = extent.box.is_empty() ? room_of({}, run.scene) : extent.box;
  const std::int32_t rank_count = extent.ranks;
  const Vec3 gravity = run.scene.settings.gravity;
  const View view = view_of(room, gravity);

  std::string text =
      "# Opens this run in ParaView 5.11 or newer with every body in its true shape. Written by scree-post.\n"
      "#\n"
      "#   paraview --script=open_in_paraview.py                          look at it\n"
      "#   pvbatch open_in_paraview.py --picture rocks.png --frame 10     a picture, without a window\n"
      "#   ... --colour velocity | rank | material                        other colours; --network: contact forces as tubes\n"
      "#   ... --colour fragment --apart 0.5                              fragments of bonded bodies, apart\n"
      "#   ... --bonds normal_stress | shear_stress | load                 faces of bonds by what they bear\n"
      "#   ... --load pressure | shear | sliding_power ...                 walls by their load maps\n"
      "#\n"
      "# More frames may be added to the run later: they are found through its frames.hdf.series.\n"
      "import argparse\nimport os\nimport sys\n\nimport paraview.simple\nfrom paraview.simple import *\n\n";
  text += fmt::format("NAME = {}\n", quoted(run.name));
  text += fmt::format("RUN = {}  # the run folder, seen from the folder of this script\n", quoted(run_from_script));
  text += fmt::format("FOLDER_WHEN_WRITTEN = {}  # used only when nothing else tells where the script is\n", quoted(script_folder));
  text += fmt::format("SHAPES = [{}]\n", shapes);
  text += fmt::format("MATERIALS = [{}]\n", materials);
  text += fmt::format("SHAPES_OF_BODIES, MATERIALS_OF_BODIES = [{}], [{}]  # the others are of walls\n", fmt::join(body_shapes, ", "),
                      fmt::join(body_materials, ", "));
  text += fmt::format("RANKS = {}\n", rank_count);
  text += fmt::format("COLOURS = [{}]\n", colours);
  std::string loads;
  for (const LoadQuantity& q : kLoadQuantities) loads += fmt::format("{}\"{}\": \"{}\"", loads.empty() ? "" : ", ", q.name, q.title);
  text += fmt::format("LOADS = {{{}}}\nHAS_LOADS = {}\n", loads, has_load_maps(run.scene) ? "True" : "False");
  std::string bonded, quantities;
  std::vector<std::int64_t> ids;
  for (const Bond& bond : run.scene.bonds) ids.insert(ids.end(), {bond.a, bond.b});
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  for (const std::int64_t id : ids) bonded += fmt::format("{}{}", bonded.empty() ? "" : ", ", id);
  for (const BondQuantity& q : kBondQuantities)
    quantities += fmt::format("{}\"{}\": \"{}\"", quantities.empty() ? "" : ", ", q.name, q.title);
  text += fmt::format("BONDED = [{}]  # bodies with bonds\nBONDS = {{{}}}\n", bonded, quantities);
  text += fmt::format("SIZE = {}  # mean equivalent diameter [m]\n", size);
  text += fmt::format("CENTRE, RADIUS = {}, {}  # of what is drawn [m]\n", list(view.centre), view.radius);
  text += fmt::format("FROM, UP = {}, {}  # direction to the camera; against gravity\n", list(view.from), list(view.up));
  return text + kBody;
}

}  // namespace scree
