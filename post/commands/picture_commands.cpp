// Pictures and films, which share what is drawn and from where.
#include <cstdlib>
#include <memory>

#include "core/base/command_line.hpp"
#include "core/base/error.hpp"
#include "core/base/expect_ending.hpp"
#include "core/base/units.hpp"
#include "post/commands/commands.hpp"
#include "post/run/body_colours.hpp"
#include "post/run/bonds_in_frame.hpp"
#include "post/run/choice.hpp"
#include "post/run/wall_loads.hpp"
#include "post/vtk/vtk_or_not.hpp"

namespace scree {

namespace {

/// A finite number of a range: CLI::Range lets nan pass, and CLI::PositiveNumber names the largest double digit by digit.
CLI::Validator between(double least, double most) {
  return CLI::Validator(
      [least, most](const std::string& text) {
        char* end = nullptr;
        const double value = std::strtod(text.c_str(), &end);
        const bool fits = end != text.c_str() && *end == '\0' && value >= least && value <= most;
        return fits ? std::string() : fmt::format("{} found, a number from {:g} to {:g} expected", text, least, most);
      },
      fmt::format("FLOAT in [{:g} - {:g}]", least, most));
}

/// What is drawn, and from where.
struct LookOptions {
  PictureOptions picture;
  std::vector<double> from, at, up, range;
  std::vector<int> size;
  std::string cut;
  bool no_walls = false, no_legend = false;

  void add_to(CLI::App& command) {
    command.add_option("--colour", picture.colour, "Of bodies: " + body_colour_list() + " (default shape)")
        ->check(CLI::IsMember(body_colour_names()));
    command.add_option("--range", range, "LOW HIGH: ends of the scale of colours, or of forces (default: those that occur)")->expected(2);
    command.add_option("--load", picture.load, "Walls coloured by their load maps, means since the start of the run, without the bodies")
        ->check(CLI::IsMember(load_names()));
    command.add_flag("--network", picture.network, "Contact forces as tubes, bodies translucent");
    command.add_option("--bonds", picture.bonds, "Faces of the bonds that hold, coloured by what they bear; bodies translucent")
        ->check(CLI::IsMember(bond_quantity_names()));
    command
        .add_option("--apart", picture.apart, "Fragments apart: moved from the middle of their body by this share of their way (default 0)")
        ->check(between(0, 100));
    command.add_option("--cut", cut, "Cut away what is before a plane, as seen from the camera: y=0, \"x=2 cm\"");
    command.add_option("--within", picture.within, kWithinHelp);
    command.add_flag("--no-walls", no_walls, "Bodies only");
    command.add_flag("--no-legend", no_legend, "Without names of kinds and without a scale");
    command.add_option("--from", from, "Direction from what is seen to the camera: X Y Z")->expected(3);
    add_quantities(command, "--at", at, 3, Dimension::length,
                   "Point the camera looks at: X Y Z, the same camera for all frames (default: the middle of what is seen)");
    command.add_option("--up", up, "Direction that is up in the picture: X Y Z (default: against gravity)")->expected(3);
    command.add_option("--zoom", picture.zoom, "2 is twice as near (default 1: everything is seen)")->check(between(1e-6, 1e6));
    command.add_option("--size", size, "WIDTH HEIGHT in pixels (default 1280 960)")->expected(2)->check(CLI::Range(16, 8192));
  }

  PictureOptions chosen() const {
    const auto vector_of = [](const std::vector<double>& v) -> std::optional<Vec3> {
      if (v.empty()) return std::nullopt;
      return Vec3{v[0], v[1], v[2]};
    };
    const auto direction_of = [&](const std::vector<double>& v, const char* name) {
      const std::optional<Vec3> direction = vector_of(v);
      if (direction && !(length(*direction) > 0)) throw UsageError("{} 0 0 0: is no direction", name);
      return direction;
    };
    PictureOptions look = picture;
    look.from = direction_of(from, "--from");
    look.at = vector_of(at);
    look.up = direction_of(up, "--up");
    look.walls = !no_walls;
    look.legend = !no_legend;
    if (!size.empty()) {
      look.width = size[0];
      look.height = size[1];
    }
    if (!range.empty()) {
      if (!(range[0] < range[1])) throw UsageError("--range {:g} {:g}: the first number must be the smaller one", range[0], range[1]);
      look.range = {range[0], range[1]};
    }
    if (!cut.empty()) look.cut = plane_of(cut);
    return look;
  }

  /// Fails: UsageError where the run does not have what is to be drawn.
  static void check(const Run& run, const PictureOptions& look) {
    if (!look.load.empty() && !has_load_maps(run.scene))
      throw UsageError("--load {}: no wall of {} has a load map; set load_map = true in [[walls]] of the case and run it again", look.load,
                       run.folder);
    if ((!look.bonds.empty() || look.apart > 0) && run.scene.bonds.empty())
      throw UsageError("{}: the scene of {} has no bonds", look.bonds.empty() ? "--apart" : "--bonds " + look.bonds, run.folder);
    if (look.network && !look.bonds.empty()) throw UsageError("--network, --bonds: give one of them");
    if (look.network && !run.scene.settings.output_contacts)
      throw UsageError("--network: {} kept no contacts; set contacts = true in [output] of the case and run it again", run.folder);
  }

 private:
  static std::pair<int, double> plane_of(const std::string& text) {
    const std::size_t equals = text.find('=');
    const std::size_t axis = equals == 1 ? std::string("xyz").find(text[0]) : std::string::npos;
    if (axis == std::string::npos) throw UsageError("--cut {}: expected an axis and a place, for instance y=0 or \"x=2 cm\"", text);
    return {static_cast<int>(axis), parse_quantity(text.substr(equals + 1), Dimension::length, "--cut " + text)};
  }
};

}  // namespace

Command add_picture(CLI::App& app) {
  struct Options {
    RunOptions run;
    LookOptions look;
    std::string output;
    std::int64_t frame = -1;
  };
  const auto o = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("picture", "Draw one frame with true shapes");
  o->run.add_to(*command, nullptr);
  command->add_option("-o,--output", o->output, "Picture to write (.png)")->required();
  command->add_option("--frame", o->frame, "Number of the frame; -1 is the last (default)");
  command->add_flag("--time", o->look.picture.time, "Write the time into the corner");
  o->look.add_to(*command);
  return {command, [o] {
            expect_ending("-o", o->output, "a picture", {".png"});
            require_vtk();
            const PictureOptions look = o->look.chosen();
            CommandResult result;
            const Run run = o->run.open(result.notices);
            LookOptions::check(run, look);
            if (const std::string unseen = make_picture(run, find_frame(run, o->frame), o->output, look); !unseen.empty())
              result.notices.push_back("note: " + unseen);
            result.notices.push_back("wrote " + o->output);
            return result;
          }};
}

Command add_film(CLI::App& app) {
  struct Options {
    RunOptions run;
    LookOptions look;
    FilmOptions film;
    std::string output;
    bool no_time = false;
  };
  const auto o = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("film", "Make a film of the frames with true shapes, through ffmpeg");
  o->run.add_to(*command, "Frames: all, last, 7, 0,5,-1, 10:50, ::5 (first:last:step; default all)");
  command->add_option("-o,--output", o->output, "Film to write (.mp4, .webm or .gif)")->required();
  command->add_option("--rate", o->film.rate, "Frames of the run in a second of film (default 25)")->check(between(0.1, 240));
  command->add_option("--turn", o->film.turn, "Degrees that the camera goes round in the film (default 0)")->check(between(-36000, 36000));
  command->add_flag("--no-time", o->no_time, "Without the time in the corner");
  o->look.add_to(*command);
  return {command, [o] {
            expect_ending("-o", o->output, "a film", {".mp4", ".webm", ".gif"});
            require_vtk();
            CommandResult result;
            FilmOptions& film = o->film;
            film.picture = o->look.chosen();
            film.picture.time = !o->no_time;
            const Run run = o->run.open(result.notices);
            LookOptions::check(run, film.picture);
            film.frames = choose_frames(run, o->run.frames);
            film.pool = {o->run.jobs, o->run.skip_damaged};
            std::vector<std::string> skipped;
            result.output = make_film(run, o->output, film, skipped) + "\n";
            for (const std::string& message : skipped) result.notices.push_back("left out: " + message);
            result.notices.push_back("wrote " + o->output);
            return result;
          }};
}

}  // namespace scree
