// Any bytes as the journal of a film in the making: they are refused in one line that names the file, or it
// is one that `join` and `--resume` can work with, in a time that does not hang on what it says.

#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "app/console/exit.h"
#include "app/film/store.h"
#include "app/run/frames.h"
#include "app/run/shots.h"
#include "media/error.h"
#include "scene/error.h"

#include "../fuzz/rooms.h"

namespace obscura {
namespace {

namespace fs = std::filesystem;

// a folder for one film, and none when the target ends
struct Film {
  fs::path folder = fs::temp_directory_path() / ("obscura-fuzz-" + std::to_string(::getpid()));
  app::Output output{app::Output::Form::movie, (folder / "film.mp4").string()};
  app::Journal journal;
  std::string written;  // the journal as a store writes it

  Film() {
    app::Origin& origin = journal.origin;
    origin = app::origin_of(fuzz::scene_of(false));
    origin.frames = 600, origin.shots = "0..599", origin.shot = app::Shot{};
    origin.encoder = "libx264", origin.preset = "medium", origin.crf = 18;
    journal.takes = 10, journal.take_frames = 60, journal.shards = 4;
    { const app::Store store(output, journal, 0, journal.takes, app::Earlier::replace); }
    written = app::file_bytes(path());
  }
  ~Film() {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }
  std::string path() const { return (fs::path(output.parts()) / "journal.json").string(); }
};

template <class Work>
void refused_or_done(const Work& work) {
  const auto one_line = [](const std::string& said) {
    if (said.find('\n') != std::string::npos) fuzz::fail("says two lines: " + said);
  };
  try {
    work();
  } catch (const media::Error& error) {
    one_line(error.what());
  } catch (const app::UsageError& error) {
    one_line(error.what());
  } catch (const scene::Error&) {
  }
}

}  // namespace
}  // namespace obscura

// The first byte: whether the others are the journal, or are laid over a good one, a place of two bytes and
// then a byte.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace obscura;
  static const Film film;
  if (size < 1) return 0;
  std::string text(reinterpret_cast<const char*>(bytes + 1), size - 1);
  if (bytes[0] & 1) {
    const std::string over = std::move(text);
    text = film.written;
    for (std::size_t at = 0; at + 3 <= over.size(); at += 3)
      text[(std::uint8_t(over[at]) | std::size_t(std::uint8_t(over[at + 1])) << 8) % text.size()] =
          over[at + 2];
  }
  std::ofstream(film.path(), std::ios::binary) << text;

  // as join does, of a movie and of pictures
  refused_or_done([&] {
    app::Store store(film.output);
    const app::Journal& journal = store.journal();
    for (std::int64_t take = 0; take < journal.takes; ++take) {
      if (store.part(take)) fuzz::fail("a part out of nothing");
    }
  });
  refused_or_done([&] {
    const app::Store store(film.output);
    const app::Journal& journal = store.journal();
    const scene::Scene scene = app::scene_of(journal.origin);
    const app::Shots shots = app::shots_of(journal.origin, scene);
    const std::int64_t last = std::min((journal.takes - 1) * journal.take_frames, journal.origin.frames - 1);
    shots[last];
    for (int k = 1; k <= journal.shards; ++k) app::Store::share(journal.takes, k, journal.shards);
  });
  // as --resume does, of another film
  refused_or_done(
      [&] { const app::Store store(film.output, film.journal, 0, film.journal.takes, app::Earlier::go_on); });
  return 0;
}
