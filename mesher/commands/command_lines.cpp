#include "mesher/commands/command_lines.hpp"

#include <memory>

namespace scree {

namespace {

using Words = std::vector<std::string>;

MesherCommand check_line(CLI::App& app) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* line = app.add_subcommand("check", "Report whether a mesh file can be a rigid body; exit 3 if not");
  line->add_option("FILE", options->file, "Mesh file (stl obj ply off 3ds dae bmf ...)")->required();
  line->add_option("--unit", options->unit, "Unit of the numbers in the file (default: what the file states, else m)");
  line->add_option("--scale", options->scale, "Factor on top of the unit");
  line->add_flag("--json", options->json, "Machine-readable output");
  return {line, [options](const Words&) { return check_command(*options); }};
}

MesherCommand import_line(CLI::App& app) {
  auto options = std::make_shared<ImportOptions>();
  CLI::App* line = app.add_subcommand("import", "Import mesh files into one shape file");
  line->add_option("FILE", options->files, "Mesh files, one shape each")->required();
  line->add_option("-o,--output", options->output, "NAME.shape.h5")->required();
  line->add_option("--unit", options->unit, "Unit of the numbers in the files (default: what a file states, else m)");
  line->add_option("--scale", options->scale, "Factor on top of the unit");
  line->add_option("--diameter", options->diameter, "Of the ball of equal volume, \"20 mm\": sets the size, whatever the unit");
  line->add_option("--name", options->names, "Name of the shape; repeat it for each file (default: file name)")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  line->add_flag("--surface", options->surface, "Import as a wall: can be open, no mass, coordinates kept");
  line->add_flag("--flip", options->flip, "Turn triangles that face inward or disagree (a surface whose triangles agree: all of them)");
  return {line, [options](const Words& words) { return import_command(*options, words); }};
}

void add_edit_options(CLI::App* line, EditOptions& options) {
  line->add_option("FILE", options.file, "Mesh file, or NAME.shape.h5")->required();
  line->add_option("-o,--output", options.output, "NAME.shape.h5, or a mesh: NAME.stl .ply .obj .off")->required();
  line->add_option("--unit", options.unit, "Unit of the numbers in the file (default: what the file states, else m)");
  line->add_option("--scale", options.scale, "Factor on top of the unit");
  line->add_flag("--surface", options.surface, "A wall: the result can be open and has no mass");
  line->add_option("--picture", options.picture, "Draw before and after into this PNG");
}

MesherCommand repair_line(CLI::App& app) {
  auto options = std::make_shared<RepairOptions>();
  CLI::App* line = app.add_subcommand("repair", "Make a solid from a broken mesh, or report why there is none");
  add_edit_options(line, *options);
  line->add_option("--weld", options->weld, "Weld all vertices nearer than this part of the extent, for instance 1e-4");
  line->add_option("--largest-fill", options->largest_fill, "Largest share of the area for all filled holes together (default 0.2)");
  line->add_flag("--largest", options->keep_largest, "Keep only the component of largest volume");
  line->add_option("--component", options->component, "Keep only this component, counted as check lists them")
      ->check(CLI::Range(1, 1000000000));
  line->add_flag("--separate", options->separate, "Make a separate shape from each component");
  return {line, [options](const Words& words) { return repair_command(*options, words); }};
}

MesherCommand simplify_line(CLI::App& app) {
  auto options = std::make_shared<SimplifyOptions>();
  CLI::App* line = app.add_subcommand("simplify", "Fewer triangles for the same shape, with the distance from it");
  add_edit_options(line, *options);
  line->add_option("--triangles", options->triangles, "Number of triangles; a list 2000,500,100 makes levels of detail in one file")
      ->required()
      ->delimiter(',');
  line->add_flag("--keep-topology", options->keep_topology, "Keep handles and necks that are smaller than a triangle");
  return {line, [options](const Words& words) { return simplify_command(*options, words); }};
}

MesherCommand refine_line(CLI::App& app) {
  auto options = std::make_shared<RefineOptions>();
  CLI::App* line = app.add_subcommand("refine", "More triangles for the same surface");
  add_edit_options(line, *options);
  line->add_option("--edge-length", options->edge_length, "Longest edge of the result");
  line->add_option("--times", options->times, "Number of times that every triangle is split in four");
  return {line, [options](const Words& words) { return refine_command(*options, words); }};
}

MesherCommand hull_line(CLI::App& app) {
  auto options = std::make_shared<HullOptions>();
  CLI::App* line = app.add_subcommand("hull", "The convex hull of a mesh, with the distance from it");
  add_edit_options(line, *options);
  return {line, [options](const Words& words) { return hull_command(*options, words); }};
}

MesherCommand remesh_line(CLI::App& app) {
  auto options = std::make_shared<RemeshOptions>();
  CLI::App* line = app.add_subcommand("remesh", "A new closed mesh around all that a mesh encloses");
  add_edit_options(line, *options);
  line->add_option("--edge-length", options->edge_length, "Of the new triangles");
  line->add_option("--triangles", options->triangles, "Or how many, about");
  line->add_option("--largest-change", options->largest_change, "Largest relative change of the volume (default 0.2)");
  return {line, [options](const Words& words) { return remesh_command(*options, words); }};
}

MesherCommand describe_line(CLI::App& app) {
  auto options = std::make_shared<DescribeOptions>();
  CLI::App* line = app.add_subcommand("describe", "Sphericity, convexity, elongation ... of meshes, shapes or folders of them");
  line->add_option("FILE", options->files, "Mesh files, shape files, folders")->required();
  line->add_option("--unit", options->unit, "Unit of the numbers in mesh files (default: what a file states, else m)");
  line->add_option("--scale", options->scale, "Factor on top of the unit");
  line->add_option("--csv", options->csv, "Write the table, with all columns, into this file");
  return {line, [options](const Words&) { return describe_command(*options); }};
}

MesherCommand generate_line(CLI::App& app) {
  auto options = std::make_shared<GenerateOptions>();
  CLI::App* line = app.add_subcommand("generate",
                                      "Generate primitives, Platonic solids, tablets, lobes, cylinders with holes, hooks, sleepers, "
                                      "screws, paddle wheels, rocks and stones");
  line->add_option("SHAPE", options->what, "What to make")->required()->check(CLI::IsMember(generated_shapes()));
  line->add_option("--radius", options->radius,
                   "Of sphere, cylinder, capsule, cone (below), torus (ring), tablet, hollow_cylinder, each lobe, and of what a screw or "
                   "paddle_wheel reaches: \"5 mm\"");
  line->add_option(
      "--height", options->height,
      "Of cylinder, capsule (between the balls), cone, tablet (its band), hollow_cylinder, lobes, screw, paddle_wheel, along z");
  line->add_option("--size", options->size,
                   "Box, ellipsoid, superellipsoid, sleeper: \"x, y, z\"; hook, u: \"width, left leg, right leg\"; Platonic: edge");
  line->add_option("--tube-radius", options->tube_radius, "Of the torus and of the rod of hook and u");
  line->add_option("--upper-radius", options->upper_radius, "Of the cone; without it the cone has a tip");
  line->add_option("--cup", options->cup, "Tablet: depth of each cap, at most the radius");
  line->add_option("--bevel", options->bevel, "Tablet: width of a bevelled edge around flat faces; without it caps are round");
  line->add_option("--inner-radius", options->inner_radius, "Hollow_cylinder: of the hole in the middle; with it alone a Raschig ring");
  line->add_option("--holes", options->holes, "Hollow_cylinder: so many holes around the middle, at equal angles");
  line->add_option("--hole-radius", options->hole_radius, "Hollow_cylinder: of each of these holes");
  line->add_option("--hole-circle", options->hole_circle, "Hollow_cylinder: distance of their centres from the axis");
  line->add_option("--lobes", options->lobes, "Lobes: their number, from 2");
  line->add_option("--spread", options->spread, "Lobes: distance of their centres from the axis (default: the radius)");
  line->add_option("--shaft-radius", options->shaft_radius, "Screw, paddle_wheel: of the shaft");
  line->add_option("--thickness", options->thickness, "Screw: of a flight along the axis; paddle_wheel: of a blade");
  line->add_option("--pitch", options->pitch, "Screw: length in which a flight goes round once");
  line->add_option("--starts", options->starts, "Screw: number of flights (default: 1)");
  line->add_flag("--left-handed", options->left_handed, "Screw: its flights turn clockwise on their way up");
  line->add_option("--blades", options->blades, "Paddle_wheel: their number");
  line->add_option("--twist", options->twist, "Paddle_wheel: angle by which the blades turn over the height: \"30 deg\"");
  line->add_option("--top-width", options->top_width, "Sleeper: width of its upper face (default: that of the lower one)");
  line->add_option("--rounding", options->rounding,
                   "Box, Platonic: radius of its edges and corners; --edge-length is then that of the rounding");
  line->add_option("--exponents", options->exponents, "Of the superellipsoid: \"e, n\", from 0.1 (a box) over 1 to 2");
  line->add_option("--diameter", options->diameter, "Rock, stone: of the ball of equal volume");
  line->add_option("--elongation", options->elongation, "Rock, stone: I / L, a number or a range 0.6..0.9");
  line->add_option("--flatness", options->flatness, "Rock, stone: S / I, a number or a range");
  line->add_option("--roughness", options->roughness, "Rock: rms height of the bumps over the radius");
  line->add_option("--triangles", options->triangles, "Rock: how many; stone: eight for each plane that cuts it");
  line->add_option("--seed", options->seed, "Rock, stone: the same seed gives the same particle");
  line->add_option("--count", options->count, "Rock, stone: a family of so many variants");
  line->add_option("--edge-length", options->edge_length, "Of the triangles (default: what suits the shape)");
  line->add_flag("--analytic", options->analytic, "Sphere without triangles: exact and cheapest");
  line->add_option("-o,--output", options->output, "NAME.shape.h5")->required();
  line->add_option("--name", options->name, "Name of the shape (default: its kind)");
  return {line, [options](const Words& words) { return generate_command(*options, words); }};
}

MesherCommand fracture_line(CLI::App& app) {
  auto options = std::make_shared<FractureOptions>();
  CLI::App* line = app.add_subcommand("fracture", "Cut a solid into Voronoi cells that share faces, for bonds that break");
  line->add_option("FILE", options->file, "NAME.shape.h5")->required();
  line->add_option("--shape", options->shape, "Name of the solid to cut, where the file holds several shapes");
  line->add_option("--cells", options->cells, "Number of cells, each around a random point in the body");
  line->add_option("--seed", options->seed, "The same seed gives the same cells");
  line->add_flag("--evenly", options->evenly, "Move the points to the centres of their cells: cells of more equal size");
  line->add_option("--inset", options->inset,
                   "Move the shared faces of each piece inwards by the margin of the case, so that pieces start in touch");
  line->add_option("--points", options->points, "CSV file with columns x, y, z [m] of the points, in place of random ones");
  line->add_option("-o,--output", options->output, "NAME.shape.h5: the pieces and their faces")->required();
  line->add_option("--picture", options->picture, "Draw the body, whole and exploded, into this PNG");
  return {line, [options](const Words& words) { return fracture_command(*options, words); }};
}

MesherCommand info_line(CLI::App& app) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* line = app.add_subcommand("info", "Show the shapes in a shape file and where they come from");
  line->add_option("FILE", options->file, "NAME.shape.h5")->required();
  line->add_option("--picture", options->picture, "Draw the shapes side by side into this PNG");
  return {line, [options](const Words&) { return info_command(*options); }};
}

}  // namespace

std::vector<MesherCommand> add_commands(CLI::App& app) {
  return {check_line(app),  import_line(app),   repair_line(app),   simplify_line(app), refine_line(app), hull_line(app),
          remesh_line(app), describe_line(app), generate_line(app), fracture_line(app), info_line(app)};
}

}  // namespace scree
