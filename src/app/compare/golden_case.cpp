#include "app/compare/golden_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <iterator>

#include "app/compare/comparison.h"
#include "app/compare/golden_record.h"
#include "app/console/exit.h"
#include "app/run/diagnosis.h"
#include "app/run/imported_run.h"
#include "media/error.h"
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

// Leaves the picture of what fails, and the difference, for a person to look at. Where they cannot be written
// the verdict stands all the same.
void leave_evidence(const std::string& made_of, const Pictured& made, const GoldenOptions& options,
                    GoldenCase& it) {
  const std::string stem = actual_of(made_of, options) + "-" + it.time;
  const std::string actual = stem + ".png";
  try {
    write(actual, made);
    it.attachments.push_back(actual);
    it.lines.push_back(actual + " is what there is now; --update takes it");
    if (!it.expected) return;
    const std::string difference = stem + ".difference.png";
    media::write_png(difference, media::difference_picture(*it.expected, made.image));
    it.attachments.push_back(difference);
  } catch (const media::Error& error) {
    it.exit = kFiles;
    it.lines.push_back(error.what());
  }
}

bool other_gl(const Origin& a, const Origin& b) {
  return a.gl_version != b.gl_version || a.gl_renderer != b.gl_renderer || a.native != b.native;
}

// the state first: when only the picture differs, the physics is innocent
void judge(const scene::Golden& golden, const media::Png& reference, const Pictured& made,
           const GoldenOptions& options, GoldenCase& it) {
  const std::optional<Origin> origin = origin_in(reference.tags);
  if (origin) it.expected_by = origin->drawn_by();
  const bool state = !origin || origin->state == made.origin.state;
  const bool sizes = reference.image.width == made.image.width && reference.image.height == made.image.height;
  const media::Difference d =
      sizes ? media::difference(reference.image, made.image, golden.level) : media::Difference{};
  it.state = "same";
  if (!d.same()) it.difference = d;
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
  if (pixels && state && d.same()) {
    // another mass of what falls freely shows in neither
    if (origin && (origin->scene_text != made.origin.scene_text || origin->sets != made.origin.sets))
      if (const std::string line = other_scene(*origin, made.origin); !line.empty())
        it.lines.push_back("state and picture are the same; " + line);
    return;
  }

  // the tolerance
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
    it.cause = cause(origin, made.origin, !sizes || !d.same());
    it.lines.insert(it.lines.end(), it.cause->lines.begin(), it.cause->lines.end());
  }
}

// a moment as names of references end
std::string instant_text(sim::Rational time) { return fmt::format("{}", sim::value(time)); }

bool is_time(const std::string& text) {
  double time = 0;
  const char* end = text.data() + text.size();
  if (text.empty() || !std::isdigit(static_cast<unsigned char>(text[0]))) return false;
  const auto parsed = std::from_chars(text.data(), end, time);
  return parsed.ec == std::errc() && parsed.ptr == end;
}

// the reference's picture may be a pointer of git-LFS, or cut: that is this moment's fault alone
void judge_picture(const scene::Golden& golden, const Pictured& made, const GoldenOptions& options,
                   GoldenCase& it) {
  try {
    media::Png reference = media::read_png(it.file);
    judge(golden, reference, made, options, it);
    it.expected = std::move(reference.image);
  } catch (const media::Error& error) {
    it.state = "unreadable", it.exit = kFiles;
    it.lines.push_back(error.what());
  }
}

// The pictures of a scene that keeps hashes lie beside its record, in a folder that git passes over.
std::string kept_picture(const GoldenCase& it) {
  const fs::path record = it.file;
  return (record.parent_path() / "pictures" / fmt::format("{}-{}.png", record.stem().string(), it.time))
      .string();
}

void keep_picture(const GoldenCase& it, const Pictured& made) {
  const fs::path file = kept_picture(it), ignore = file.parent_path() / ".gitignore";
  write(file.string(), made);
  if (!fs::exists(ignore)) write_text(ignore.string(), "*\n");
}

// holds a moment against its hashes, and against the picture that they are of where it lies at hand
void judge_record(const scene::Golden& golden, const GoldenRecord& record, const Pictured& made,
                  const GoldenOptions& options, GoldenCase& it) {
  const GoldenRecord::Moment& reference = record.moments.at(it.time);
  const GoldenRecord::Moment there = moment_of(made);
  const bool state = reference.state == there.state, pixels = reference.pixels == there.pixels;
  const std::string file = kept_picture(it);
  std::optional<media::Png> picture;
  try {
    if (fs::exists(file)) picture = media::read_png(file);
  } catch (const media::Error&) {
    // as if it were not there
  }
  if (picture && pixel_hash(picture->image) != reference.pixels) picture.reset();
  if (const auto of = picture ? origin_in(picture->tags) : std::nullopt; of && !of->sets.empty())
    picture.reset();
  const bool text = record.scene == record_of({it.time}, {made}).scene;
  // a record is of the scene as its file says, and so are the pictures beside it
  const std::string sets = made.origin.sets.empty() ? "" : " with " + made.origin.set_flags();
  if (state && pixels) {
    it.state = "same";
    if (!text) it.lines.push_back("state and picture are the same; the text of the scene is another one");
    if (!sets.empty()) it.lines.push_back("state and picture are the same" + sets);
    try {
      // a picture tells what it is of
      if (!picture && text && sets.empty()) keep_picture(it, made);
    } catch (const media::Error&) {
      // if the folder is not writable, the next difference is reported without it
    }
    return;
  }
  if (picture) {
    judge(golden, *picture, made, options, it);
    it.expected = std::move(picture->image);
    return;
  }
  if (!pixels)
    it.lines.push_back(
        fmt::format("the picture is another one; by how much is not known: that of the "
                    "reference is not at {}, outside git",
                    file));
  if (!state)
    it.lines.push_back(pixels ? "the state is another one, though the picture is the same"
                              : "the state is another one");
  const GoldenRecord now = record_of({it.time}, {made});
  if (pixels && !golden.states) {
    it.state = "tolerated";
    it.lines.push_back("tolerated: " + golden.reason);
  } else if (state && options.states_only_on_other_gl && record.gl != now.gl) {
    it.state = "tolerated";
    it.lines.push_back(
        fmt::format("the state is the same; drawn by another OpenGL, {} and {}", record.gl, now.gl));
  } else {
    it.state = "differs";
    if (!text) it.lines.push_back("the scene's text is another one than the reference's");
    if (!sets.empty())
      it.lines.push_back("other scene: that of the reference" + sets);
    else if (text && !state)
      it.lines.push_back("other state of the same scene");
    if (record.gl != now.gl) it.lines.push_back(fmt::format("other OpenGL: {} and {}", record.gl, now.gl));
  }
}

// The record of a scene that keeps hashes, as it lies beside it.
struct Record {
  std::string file, fault;  // fault: why it cannot be read
  std::optional<GoldenRecord> there;

  explicit Record(std::string named) : file(std::move(named)) {}

  void read() {
    try {
      if (fs::exists(file)) there = read_record(file);
    } catch (const media::Error& error) {
      fault = error.what();
    }
  }

  void hold(const scene::Golden& golden, const Pictured& made, const GoldenOptions& options,
            GoldenCase& it) const {
    if (!fault.empty()) {
      it.state = "unreadable", it.exit = kFiles;
      it.lines.push_back(fault);
    } else if (!there || !there->moments.contains(it.time)) {
      it.state = "missing";
      it.lines.push_back(
          fmt::format("{}: there is no such reference{}", file, there ? ", of t = " + it.time + " s" : ""));
    } else {
      judge_record(golden, *there, made, options, it);
    }
  }

  // writes it anew, if that is asked for, and tells of moments in it that the scene has no more
  void settle(const scene::Golden& golden, std::vector<GoldenCase>& cases, const std::vector<Pictured>& made,
              const GoldenOptions& options) const {
    std::vector<std::string> all, times;
    bool changes = false;
    for (const sim::Rational& each : golden.at) all.push_back(instant_text(each));
    for (const GoldenCase& it : cases) times.push_back(it.time);
    GoldenRecord now = record_of(times, made);
    now.moments = there ? there->moments : decltype(now.moments){};
    for (std::size_t i = 0; i < cases.size(); ++i) {
      if (cases[i].state != "updated") continue;
      changes = true;
      now.moments[times[i]] = moment_of(made[i]);
      keep_picture(cases[i], made[i]);
    }
    std::erase_if(now.moments, [&](const auto& entry) {
      const std::string& time = entry.first;
      if (!options.only.empty() || std::find(all.begin(), all.end(), time) != all.end()) return false;
      changes = true;
      cases.back().lines.push_back(
          fmt::format("{}: t = {} s {}", file, time,
                      options.update ? "is removed: it is no moment of the scene any more"
                                     : "is no moment of the scene any more; --update removes it"));
      return true;
    });
    if (!options.update || !changes) return;
    media::make_folder_of(file);
    write_text(file, now.text());
  }
};

void miss(const scene::Scene& scene, const GoldenOptions& options, GoldenCase& it) {
  it.state = "missing";
  it.lines.push_back(it.file + ": there is no such reference");
  const fs::path flat = fs::path(options.references) / fs::path(it.file).filename();
  if (!options.references.empty() && flat != it.file && fs::exists(flat))
    it.lines.push_back(fmt::format("{} would be it with --root {}", flat.string(),
                                   fs::path(scene.file).parent_path().string()));
}

// Another program's run instead of the simulation, if one is named. Reports remarks about it.
void take_run(const GoldenOptions& options, scene::Scene& scene, std::vector<std::string>& notes) {
  std::string file = options.states;
  if (file.empty() && !scene.golden.run.empty())
    file = (fs::path(scene.file).parent_path() / scene.golden.run).string();
  if (file.empty()) return;
  show_run(read_table(file), false, scene, notes);
  scene.film.shutter = 0;
  // tolerances for pixels tolerate other states too: another program says itself how exact it is
  if (scene.golden.level > 0 || scene.golden.pixels > 0) scene.golden.states = false;
  const std::vector<double>& times = scene.trajectory->times;
  for (const sim::Rational& each : scene.golden.at) {
    const double t = sim::value(each);
    if (scene.trajectory->has(t)) continue;
    const auto next = std::lower_bound(times.begin(), times.end(), t);
    std::string near;
    if (next != times.begin()) near = fmt::format("{:g} s", *(next - 1));
    if (next != times.end()) near += fmt::format("{}{:g} s", near.empty() ? "" : " and ", *next);
    throw media::Error(
        fmt::format("{}: has no row at t = {:g} s, a moment of {}'s [golden]; the nearest are at {}", file, t,
                    scene.name, near));
  }
}

// references of this scene that belong to no moment of it any more
void sweep(const scene::Scene& scene, const std::string& references, const std::vector<GoldenCase>& cases,
           const GoldenOptions& options, std::vector<std::string>& lines) {
  std::error_code none;
  const fs::path folder = fs::path(references).parent_path();
  const std::string record = references + ".json";
  if (!scene.golden.hashes && fs::exists(record)) {
    if (options.update) fs::remove(record, none);
    lines.push_back(fmt::format("{} {}: the scene keeps pictures", record,
                                options.update ? "is removed" : "is not needed; --update removes it"));
  }
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(scene.name + "-") || entry.path().extension() != ".png") continue;
    bool known = false;
    for (const GoldenCase& each : cases) known = known || fs::path(each.file).filename() == name;
    // others of its name are someone else's: room-poster.png
    if (known || !is_time(entry.path().stem().string().substr(scene.name.size() + 1))) continue;
    std::optional<Origin> origin;
    try {
      origin = origin_in(media::read_png(entry.path().string()).tags);
    } catch (const media::Error& error) {
      // it may belong to another scene: leave it where it is
      lines.push_back(fmt::format("{}; it is no moment of the scene any more", error.what()));
      continue;
    }
    if (!origin || fs::path(origin->scene_file).stem() != scene.name) continue;
    if (options.update) fs::remove(entry.path(), none);
    lines.push_back(fmt::format("{} {}", entry.path().string(),
                                options.update ? "is removed: it is no moment of the scene any more"
                                               : "is no moment of the scene any more; --update removes it"));
  }
}

// removes the pictures that an earlier check of this scene left: all pictures there belong to this scene
void remove_evidence(const std::string& scene_file, const GoldenOptions& options) {
  const fs::path actual = actual_of(scene_file, options);
  const std::string start = actual.filename().string() + "-";
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(actual.parent_path(), none)) {
    std::string name = entry.path().filename().string();
    if (!name.starts_with(start) || !name.ends_with(".png")) continue;
    name = name.substr(start.size(), name.size() - start.size() - 4);
    if (name.ends_with(".difference")) name.resize(name.size() - 11);
    if (is_time(name)) fs::remove(entry.path(), none);
  }
}

// a short name of a picture and its state
std::string picture_name(const Pictured& made) {
  const media::Image& image = made.image;
  return hash(fmt::format("{}x{} {} {}", image.width, image.height,
                          hash(image.pixels.data(), image.pixels.size()), made.origin.state))
      .substr(0, 16);
}

// the argument of --only for a moment; none if it is not among those
const GoldenChoice* chosen(const std::string& name, sim::Rational time, const GoldenOptions& options) {
  for (const GoldenChoice& each : options.only)
    if (each.scene == name && sim::value(each.time) == sim::value(time)) return &each;
  return nullptr;
}

// leaves those moments of a scene that --only names, each of which it has
void choose(const std::string& name, const GoldenOptions& options, std::vector<sim::Rational>& at) {
  if (options.only.empty()) return;
  std::string known;
  for (const sim::Rational& time : at)
    known += fmt::format("{}{}", known.empty() ? "" : ", ", sim::value(time));
  std::erase_if(at, [&](const sim::Rational& time) { return !chosen(name, time, options); });
  for (const GoldenChoice& each : options.only) {
    const auto its = [&](const sim::Rational& time) { return sim::value(time) == sim::value(each.time); };
    if (each.scene == name && std::none_of(at.begin(), at.end(), its))
      throw UsageError(fmt::format("--only {}@{}: its moments are {}", name, sim::value(each.time), known));
  }
}

fs::path stem_of(const std::string& scene_file) {
  return scene_file == "-" ? "scene" : fs::path(scene_file).stem();
}

fs::path whole_path(const fs::path& folder) { return fs::weakly_canonical(folder.empty() ? "." : folder); }

}  // namespace

GoldenChoice GoldenChoice::parse(const std::string& text) {
  const std::size_t at = text.rfind('@'), colon = at == text.npos ? text.npos : text.find(':', at);
  if (at != text.npos && at > 0) {
    const std::string seconds = text.substr(at + 1, colon == text.npos ? text.npos : colon - at - 1);
    if (const auto time = sim::parse_rational(seconds))
      return {text.substr(0, at), *time, colon == text.npos ? "" : text.substr(colon + 1)};
  }
  throw UsageError(fmt::format("--only {}: expected SCENE@SECONDS, as in room@2.5", text));
}

std::string golden_name(const std::string& scene_file, const GoldenOptions& options) {
  const fs::path stem = stem_of(scene_file);
  if (scene_file == "-") return stem.string();
  const fs::path inside =
      (whole_path(fs::path(scene_file).parent_path()) / stem).lexically_relative(whole_path(options.root));
  if (!inside.empty() && *inside.begin() != "..") return inside.generic_string();
  if (!options.root.empty())
    throw UsageError(fmt::format("--root {}: {} lies outside of it", options.root, scene_file));
  if (!options.references.empty())
    throw UsageError(
        fmt::format("{} lies outside of the current folder: name the folder from which scenes are "
                    "called with --root, so that two of one name have references of their own",
                    scene_file));
  return stem.string();
}

std::string references_of(const std::string& scene_file, const GoldenOptions& options) {
  if (options.references.empty())
    return (fs::path(scene_file).parent_path() / "golden" / stem_of(scene_file)).string();
  return (fs::path(options.references) / golden_name(scene_file, options)).string();
}

std::string actual_of(const std::string& scene_file, const GoldenOptions& options) {
  return (fs::path(options.actual) / golden_name(scene_file, options)).string();
}

std::vector<GoldenCase> check_golden(const scene::Scene& scene, const GoldenOptions& options) {
  remove_evidence(scene.file, options);
  scene::Scene small = scene;
  small.film.width = scene.golden.width, small.film.height = scene.golden.height;
  const std::string references = references_of(scene.file, options), name = golden_name(scene.file, options);
  const scene::Golden& golden = small.golden;
  choose(name, options, small.golden.at);
  std::vector<std::string> notes;
  take_run(options, small, notes);
  const std::vector<Pictured> made =
      pictures(small, Shots::stills(golden.at, small.film.fps, small.film.speed), options.picture);

  Record record(references + ".json");
  if (golden.hashes) record.read();
  std::vector<GoldenCase> cases;
  for (std::size_t i = 0; i < made.size(); ++i) {
    GoldenCase it;
    it.scene = name;
    it.scene_file = scene.file, it.line = golden.line;
    it.time = instant_text(golden.at[i]);
    const std::string picture = picture_name(made[i]);
    it.choice = fmt::format("{}@{}:{}", name, it.time, picture);
    it.file = golden.hashes ? record.file : fmt::format("{}-{}.png", references, it.time);
    it.actual = made[i].image, it.actual_by = made[i].origin.drawn_by();
    if (golden.hashes)
      record.hold(golden, made[i], options, it);
    else if (fs::exists(it.file))
      judge_picture(golden, made[i], options, it);
    else
      miss(scene, options, it);
    const GoldenChoice* choice = chosen(name, golden.at[i], options);
    const bool another = choice && !choice->hash.empty() && choice->hash != picture;
    if (!it.good() && another)
      it.lines.insert(it.lines.begin(), "it is not the picture that was approved: look at it again");
    if (!it.good() && options.update && !another) {
      std::string& first = it.lines.front();
      if (it.state == "missing")
        first = "new: " + it.file;
      else if (!first.starts_with(it.file))
        first = it.file + ": " + first;
      it.state = "updated", it.exit = kDone;
      if (!golden.hashes) write(it.file, made[i]);
    } else if (!it.good()) {
      leave_evidence(scene.file, made[i], options, it);
    }
    cases.push_back(std::move(it));
  }
  if (cases.empty()) return cases;
  if (golden.hashes) record.settle(scene.golden, cases, made, options);
  if (options.only.empty()) sweep(scene, references, cases, options, cases.back().lines);
  std::move(notes.begin(), notes.end(), std::back_inserter(cases.back().lines));
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
