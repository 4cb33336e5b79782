#include "mesher/command_lines.hpp"

#include <memory>

namespace scree {

namespace {

using Words = std::vector<std::string>;

MesherCommand check_line(CLI::App& app) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* line = app.add_subcommand("check", "Tell whether a mesh file can be a rigid body; exit 3 when not");
  line->add_option("FILE", options->file, "Mesh file (stl obj ply off 3ds dae bmf ...)")->required();
  line->add_option("--unit", options->unit, "Unit of the numbers in the file (default m)");
  line->add_option("--scale", options->scale, "Factor on top of the unit");
  line->add_flag("--json", options->json, "Machine-readable output");
  return {line, [options](const Words&) { return check_command(*options); }};
}

MesherCommand import_line(CLI::App& app) {
  auto options = std::make_shared<ImportOptions>();
  CLI::App* line = app.add_subcommand("import", "Import mesh files into one shape file");
  line->add_option("FILE", options->files, "Mesh files, one shape each")->required();
  line->add_option("-o,--output", options->output, "NAME.shape.h5")->required();
  line->add_option("--unit", options->unit, "Unit of the numbers in the files (default m)");
  line->add_option("--scale", options->scale, "Factor on top of the unit");
  line->add_option("--name", options->names, "Name of the shape; repeat it for each file (default: file name)")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  line->add_flag("--surface", options->surface, "Import as a wall: may be open, no mass, coordinates kept");
  line->add_flag("--flip", options->flip, "Turn triangles that face inward or disagree (a surface: all of them)");
  return {line, [options](const Words& words) { return import_command(*options, words); }};
}

void add_edit_options(CLI::App* line, EditOptions& options) {
  line->add_option("FILE", options.file, "Mesh file, or NAME.shape.h5")->required();
  line->add_option("-o,--output", options.output, "NAME.shape.h5, or a mesh: NAME.stl .ply .obj .off")->required();
  line->add_option("--unit", options.unit, "Unit of the numbers in the file (default m)");
  line->add_option("--scale", options.scale, "Factor on top of the unit");
  line->add_flag("--surface", options.surface, "A wall: the result may be open and has no mass");
  line->add_option("--picture", options.picture, "Draw before and after into this PNG");
}

MesherCommand simplify_line(CLI::App& app) {
  auto options = std::make_shared<SimplifyOptions>();
  CLI::App* line = app.add_subcommand("simplify", "Fewer triangles for the same shape, with the distance from it");
  add_edit_options(line, *options);
  line->add_option("--triangles", options->triangles, "How many; a list 2000,500,100 makes levels of detail in one file")
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
  line->add_option("--times", options->times, "Split every triangle in four this often");
  return {line, [options](const Words& words) { return refine_command(*options, words); }};
}

MesherCommand generate_line(CLI::App& app) {
  auto options = std::make_shared<GenerateOptions>();
  CLI::App* line = app.add_subcommand("generate", "Generate a sphere, box or cylinder");
  line->add_option("SHAPE", options->what, "sphere, box or cylinder")
      ->required()
      ->check(CLI::IsMember({"sphere", "box", "cylinder"}));
  line->add_option("--radius", options->radius, "Of sphere and cylinder, for instance \"5 mm\"");
  line->add_option("--height", options->height, "Of the cylinder, along z");
  line->add_option("--size", options->size, "Of the box: \"x, y, z\"");
  line->add_option("--edge-length", options->edge_length,
                   "Of the triangles (default: a quarter of the radius; box: 12 triangles)");
  line->add_flag("--analytic", options->analytic, "Sphere without triangles: exact and cheapest");
  line->add_option("-o,--output", options->output, "NAME.shape.h5")->required();
  line->add_option("--name", options->name, "Name of the shape (default: sphere, box or cylinder)");
  return {line, [options](const Words& words) { return generate_command(*options, words); }};
}

MesherCommand info_line(CLI::App& app) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* line = app.add_subcommand("info", "Show the shapes in a shape file and where they come from");
  line->add_option("FILE", options->file, "NAME.shape.h5")->required();
  return {line, [options](const Words&) { return info_command(*options); }};
}

}  // namespace

std::vector<MesherCommand> add_commands(CLI::App& app) {
  return {check_line(app),  import_line(app),   simplify_line(app),
          refine_line(app), generate_line(app), info_line(app)};
}

}  // namespace scree
