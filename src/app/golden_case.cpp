#include "app/golden_case.h"

#include <fmt/format.h>

#include <filesystem>

#include "app/cause.h"
#include "app/comparison.h"
#include "media/file.h"
#include "media/pixels.h"
#include "media/png.h"
#include "page/markup.h"

namespace obscura::app {

namespace {

namespace fs = std::filesystem;
using page::escaped;

void write(const std::string& path, const Pictured& made) {
  media::make_folder_of(path);
  media::write_png(path, made.image, {.tags = made.origin.tags("")});
}

// leaves the picture of what fails, and the difference, for a person to look at
void leave_evidence(const Pictured& made, const GoldenOptions& options, GoldenCase& it) {
  const fs::path folder = options.actual, stem = fs::path(it.file).stem();
  const std::string actual = (folder / (stem.string() + ".png")).string();
  write(actual, made);
  it.attachments.push_back(actual);
  if (!it.expected) return;
  const std::string difference = (folder / (stem.string() + ".difference.png")).string();
  media::write_png(difference, media::difference_picture(*it.expected, made.image));
  it.attachments.push_back(difference);
}

bool other_gl(const Origin& a, const Origin& b) {
  return a.gl_version != b.gl_version || a.gl_renderer != b.gl_renderer || a.native != b.native;
}

// the state first: when only the picture differs, the physics is innocent
void judge(const scene::Golden& golden, const media::Png& reference, const Pictured& made,
           const GoldenOptions& options, GoldenCase& it) {
  const std::optional<Origin> origin = origin_in(reference.tags);
  const bool state = !origin || origin->state == made.origin.state;
  const bool sizes = reference.image.width == made.image.width && reference.image.height == made.image.height;
  const media::Difference d =
      sizes ? media::difference(reference.image, made.image, golden.level) : media::Difference{};
  it.state = "same";
  if (!sizes)
    it.lines.push_back(fmt::format("other sizes: {}x{} and {}x{} pixels", reference.image.width,
                                   reference.image.height, made.image.width, made.image.height));
  else if (!d.same())
    it.lines.push_back(sentence(d));
  if (!origin)
    it.lines.push_back("the reference does not say where it comes from: its state is not compared");
  else if (!state)
    it.lines.push_back(d.same() && sizes ? "the state is another one, though the picture is the same"
                                         : "the state is another one");
  const bool pixels = sizes && d.beyond <= golden.pixels;
  if (pixels && state && d.same()) return;

  // what is let pass
  const bool lenient = (golden.level > 0 || golden.pixels > 0 || !golden.states);
  if (pixels && (state || !golden.states) && lenient) {
    it.state = "tolerated";
    it.lines.push_back("tolerated: " + golden.reason);
    return;
  }
  if (state && sizes && origin && options.states_only_on_other_gl && other_gl(*origin, made.origin)) {
    it.state = "tolerated";
    it.lines.push_back(fmt::format("the state is the same; drawn by another OpenGL, {} and {}",
                                   origin->gl_version, made.origin.gl_version));
    return;
  }
  it.state = "differs";
  if (origin) {
    const Cause why = cause(origin, made.origin);
    it.lines.insert(it.lines.end(), why.lines.begin(), why.lines.end());
  }
}

// references of this scene that belong to no moment of it any more
void sweep(const scene::Scene& scene, const std::string& folder, const std::vector<GoldenCase>& cases,
           const GoldenOptions& options, std::vector<std::string>& lines) {
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(scene.name + "-") || entry.path().extension() != ".png") continue;
    bool known = false;
    for (const GoldenCase& each : cases) known = known || fs::path(each.file).filename() == name;
    if (known) continue;
    const auto origin = origin_in(media::read_png(entry.path().string()).tags);
    if (!origin || fs::path(origin->scene_file).stem() != scene.name) continue;
    if (options.update) fs::remove(entry.path(), none);
    lines.push_back(fmt::format("{} {}", entry.path().string(),
                                options.update ? "is removed: it is no moment of the scene any more"
                                               : "is no moment of the scene any more; --update removes it"));
  }
}

}  // namespace

std::string references_of(const std::string& scene_file, const GoldenOptions& options) {
  return options.references.empty() ? (fs::path(scene_file).parent_path() / "golden").string()
                                    : options.references;
}

std::vector<GoldenCase> check_golden(const scene::Scene& scene, const GoldenOptions& options) {
  scene::Scene small = scene;
  small.film.width = scene.golden.width, small.film.height = scene.golden.height;
  const std::vector<Pictured> made =
      pictures(small, Shots::stills(scene.golden.at, scene.film.fps, scene.film.speed), options.picture);

  const fs::path folder = references_of(scene.file, options);
  std::vector<GoldenCase> cases;
  for (std::size_t i = 0; i < made.size(); ++i) {
    GoldenCase it;
    it.scene = scene.name;
    it.time = fmt::format("{}", sim::value(scene.golden.at[i]));
    it.file = (folder / fmt::format("{}-{}.png", scene.name, it.time)).string();
    it.actual = made[i].image;
    if (!fs::exists(it.file)) {
      it.state = "missing";
      it.lines.push_back(it.file + ": there is no such reference");
    } else {
      media::Png reference = media::read_png(it.file);
      judge(scene.golden, reference, made[i], options, it);
      it.expected = std::move(reference.image);
    }
    if (!it.good() && options.update) {
      it.lines.front() = (it.state == "missing" ? "new: " + it.file : it.file + ": " + it.lines.front());
      it.state = "updated";
      write(it.file, made[i]);
    } else if (!it.good()) {
      leave_evidence(made[i], options, it);
      it.lines.push_back(it.attachments.front() + " is what there is now; --update takes it");
    }
    cases.push_back(std::move(it));
  }
  if (!cases.empty()) sweep(scene, folder.string(), cases, options, cases.back().lines);
  return cases;
}

std::string junit(const std::vector<GoldenCase>& cases) {
  std::size_t failures = 0, errors = 0;
  double seconds = 0;
  std::string body;
  for (const GoldenCase& it : cases) {
    seconds += it.seconds;
    const std::string name = it.time.empty() ? "scene" : "t = " + it.time + " s";
    body += fmt::format("  <testcase classname=\"{}\" name=\"{}\" file=\"{}\" time=\"{:.3f}\">\n",
                        escaped(it.scene), escaped(name), escaped(it.file), it.seconds);
    std::string all;
    for (const std::string& line : it.lines) all += escaped(line) + "\n";
    if (!it.good()) {
      const bool broken = it.state == "failed";
      ++(broken ? errors : failures);
      body += fmt::format("    <{0} type=\"{1}\" message=\"{2}\">{3}</{0}>\n", broken ? "error" : "failure",
                          escaped(it.state), it.lines.empty() ? "" : escaped(it.lines.front()), all);
    }
    std::string out = it.good() ? all : "";
    for (const std::string& file : it.attachments)
      out += fmt::format("[[ATTACHMENT|{}]]\n", escaped(fs::absolute(file).string()));
    if (!out.empty()) body += "    <system-out>" + out + "</system-out>\n";
    body += "  </testcase>\n";
  }
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<testsuite name=\"obscura golden\" tests=\"{}\" failures=\"{}\" errors=\"{}\" time=\"{:.3f}\">\n{}"
      "</testsuite>\n",
      cases.size(), failures, errors, seconds, body);
}

}  // namespace obscura::app
