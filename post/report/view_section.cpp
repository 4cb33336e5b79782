#include "post/report/view_section.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "core/base/utf8.hpp"
#include "post/report/html.hpp"
#include "post/report/played_frames.hpp"
#include "post/report/player_data.hpp"
#include "post/report/player_script.hpp"
#include "post/vtk/view_data.hpp"
#include "post/vtk/view_script.hpp"

namespace scree {

namespace {

/// JSON that stands in a script element. "</script" would end the element, and "<!--<script" would keep its own end from being
/// seen; in JSON a '<' stands only within strings, where \u003c is the same.
std::string inside_script(const std::string& json) {
  std::string text;
  text.reserve(json.size());
  for (const char c : json) {
    if (c == '<')
      text += "\\u003c";
    else
      text += c;
  }
  return text;
}

std::string megabytes(std::size_t bytes) { return fmt::format("{:.3g} MB", 1e-6 * static_cast<double>(bytes)); }

/// Which frames the page plays, in words.
std::string words_of_frames(const PlayedRun& played, std::size_t damaged, std::size_t limit) {
  const std::size_t count = played.frames.size(), all = played.frames_of_run + damaged, left_out = played.skipped.size() + damaged;
  const std::string without = left_out == 0   ? ""
                              : left_out == 1 ? " 1 damaged frame is left out."
                                              : fmt::format(" {} damaged frames are left out.", left_out);
  if (count == all) return fmt::format("All {} frames are played.", count);
  if (count == 0 && left_out + 1 >= all) return "No other frame of the run can be read." + without;
  const std::string size = fmt::format("all frames would take {}, and a page holds at most {} of positions and orientations",
                                       megabytes(played.bytes_of_all), megabytes(limit));
  if (count == 0) {
    return fmt::format(
               "The {} frames are not played: {}, which the first, the last and the frame of the pictures alone exceed. scree-post film "
               "makes a film of them.",
               all, size) +
           without;
  }
  if (count + left_out == all) return fmt::format("{} of {} frames are played.", count, all) + without;
  return fmt::format("{} of {} frames are played, spread evenly, with the first, the last and the frame of the pictures: {}.", count, all,
                     size) +
         without;
}

std::string words_of_error(const PlayerError& error) {
  if (!(error.smallest_diameter > 0)) return "";
  return fmt::format(
      " Positions and orientations are rounded: the largest error of a position is {:.2g} m, {:.2g} of the diameter of the smallest body, "
      "and that of an orientation {:.2g} degrees.",
      error.distance, error.distance / error.smallest_diameter, error.angle * 180 / std::numbers::pi);
}

nlohmann::json numbers_of(const PlayedRun& played, const PlayerData& data) {
  return {{"frames", std::max<std::size_t>(1, played.frames.size())},
          {"frames_of_run", played.frames_of_run},
          {"bytes", data.bytes},
          {"position_error", data.error.distance},
          {"smallest_diameter", data.error.smallest_diameter},
          {"angle_error", data.error.angle}};
}

std::string player_bar(const PlayedRun& played) {
  std::string rates;
  for (const int rate : {5, 10, 25, 50}) rates += fmt::format("<option{}>{}</option>", rate == 10 ? " selected" : "", rate);
  return fmt::format(
      "<div class=\"player\"><button name=\"play\" type=\"button\">&#9654; play</button>"
      "<input type=\"range\" name=\"frame\" aria-label=\"frame\" min=\"0\" max=\"{}\" value=\"{}\" step=\"1\"/>"
      "<output></output><label><select name=\"rate\" aria-label=\"frames per second\">{}</select> frames/s</label></div>\n",
      played.frames.size() - 1, played.chosen, rates);
}

std::string tools(const Run& run, const Frame& frame, bool plays) {
  std::string html = "<div class=\"legend\"></div>\n<div class=\"tools\"><label>colour <select name=\"colour\">";
  std::vector<std::pair<const char*, const char*>> colours{
      {"shape", "shape"}, {"material", "material"}, {"speed", "speed"}, {"height", "height z"}};
  if (run.scene.settings.heat) colours.emplace_back("temperature", "temperature");
  for (const auto& [value, name] : colours) html += fmt::format("<option value=\"{}\">{}</option>", value, name);
  html += "</select></label><label>walls <select name=\"walls\">";
  for (const char* walls : {"hidden", "edges", "translucent", "opaque"})
    html += fmt::format("<option{}>{}</option>", walls == std::string("edges") ? " selected" : "", walls);
  html +=
      "</select></label><label>cut <select name=\"cut\"><option value=\"off\">off</option><option>x</option><option>y</option>"
      "<option>z</option></select></label><span class=\"cut-tools\" hidden><input type=\"range\" name=\"cut-at\" aria-label=\"place of the "
      "cut\" min=\"0\" max=\"1000\" value=\"500\"/><output class=\"cut\"></output><button name=\"cut-side\" type=\"button\">other "
      "side</button></span>";
  html += fmt::format("<label><input type=\"checkbox\" name=\"contacts\"{}/> contact forces{}</label>",
                      frame.contacts.size() > 0 ? "" : " disabled",
                      plays && frame.contacts.size() > 0 ? fmt::format(" (frame {})", frame.number) : "");
  return html +
         "<span class=\"zoom\"><button name=\"nearer\" type=\"button\">nearer</button><button name=\"further\" "
         "type=\"button\">further</button>"
         "<button name=\"reset\" type=\"button\">reset</button></span></div>\n";
}

}  // namespace

ViewSection view_section(const Run& run, std::size_t index, const std::string& within, const FramePool& pool, std::size_t limit) {
  const Within inside = Within::named(run, within);
  const Frame frame = load_frame(run, index);
  const PlayedRun played = read_played_frames(run, index, inside, pool, limit);
  const bool plays = !played.frames.empty();
  const ViewExtent extent = plays ? ViewExtent{played.room, played.most} : ViewExtent{};
  ViewSection section;
  section.skipped = played.skipped;
  std::string& html = section.html;
  html = fmt::format(
      "<p>Frame {} at t = {:.4g} s{}. Drag to turn, two fingers or Shift and drag to move, the buttons or Ctrl and the wheel to zoom, "
      "click a body to read about it{}.</p>\n",
      frame.number, frame.time, plays ? " is shown first" : "", plays ? ", press the space bar in the view to play" : "");
  html +=
      "<div class=\"view\"><canvas id=\"view-canvas\" tabindex=\"0\" aria-label=\"3D view of the bodies; arrow keys turn, plus and minus "
      "zoom\"></canvas>\n";
  if (plays) html += player_bar(played);
  html += tools(run, frame, plays) + "<p id=\"view-panel\" class=\"panel\" aria-live=\"polite\">Pick a body to read about it.</p></div>\n";
  JsonRecord drawn = view_data(run, frame, inside, extent);
  PlayerData data;
  if (plays) {
    data = player_data(run.scene, played, view_of(played.room, run.scene.settings.gravity).centre);
    (*drawn)["player"] = std::move(*data.json);
  }
  html += "<script type=\"application/json\" id=\"view-data\">" + inside_script(json_text(drawn)) + "</script>\n";
  if (run.frames.size() + run.damaged.size() > 1)
    html += "<p class=\"note\">" + words_of_frames(played, run.damaged.size(), limit) + words_of_error(data.error) + "</p>\n";
  section.numbers = numbers_of(played, data);
  html += std::string("<script>") + kViewShaders + kViewScript + (plays ? kPlayerScript : kViewStart) + "</script>\n";
  return section;
}

}  // namespace scree
