// obscura watch: the page of a scene in a browser, made anew whenever the scene is saved.

#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <thread>

#include <fmt/format.h>

#include "app/console/command.h"
#include "app/console/commands.h"
#include "app/console/exit.h"
#include "app/console/interrupt.h"
#include "app/console/options.h"
#include "app/console/say.h"
#include "app/film/film_page.h"
#include "app/run/run_marks.h"
#include "app/run/trouble.h"
#include "app/watch/server.h"
#include "draw/picture/error.h"
#include "media/error.h"
#include "page/error.h"
#include "page/html.h"
#include "scene/error.h"

namespace obscura::app {

namespace {

namespace fs = std::filesystem;

constexpr double kFirstPart = 0.5;  // s of work after which a page of what there is yet is shown; then twice
                                    // as long each time

struct WatchFlags {
  std::string scene;
  std::vector<std::string> sets;
  std::optional<std::string> fps, theme;
  int port = 0;
};

// what tells one saved version of a file from the next
struct Saved {
  fs::file_time_type time{};
  std::uintmax_t size = 0;
  bool operator==(const Saved&) const = default;
};

Saved saved(const std::string& file) {
  std::error_code none;
  Saved now{fs::last_write_time(file, none), 0};
  now.size = fs::file_size(file, none);
  return now;
}

// Makes pages of a scene, one after another, beside the thread that serves them.
class Watching {
 public:
  Watching(const WatchFlags& flags, PageServer& server) : flags_(flags), server_(server) {}

  void run() {
    Saved made{};
    for (bool first = true; !interrupted(); first = false) {
      const Saved now = saved(flags_.scene);
      if (!first && now == made) {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        continue;
      }
      made = now;
      make(now);
    }
  }

 private:
  void make(const Saved& version) {
    const auto wrong = [&](const std::string& text) {
      server_.show(page::words_page(flags_.scene, lines(text)));
      say_lines(stderr, text);
    };
    try {
      follow(version);
    } catch (const scene::Error& error) {
      wrong(error.what());
    } catch (const TroubleError& error) {
      wrong(error.what());
    } catch (const UsageError& error) {
      wrong(error.what());
    } catch (const media::Error& error) {
      wrong(error.what());
    } catch (const draw::Error& error) {
      wrong(error.what());
    } catch (const page::Error& error) {
      wrong(error.what());
    } catch (const Interrupted&) {
    }
  }

  void follow(const Saved& version) {
    const auto begun = std::chrono::steady_clock::now();
    const auto seconds = [&] {
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    };
    scene::Scene scene = with_run_marks(scene::read(flags_.scene, flags_.sets));
    if (flags_.fps) scene.film.fps = parse_fps(*flags_.fps);
    if (flags_.theme) scene.look.theme = *flags_.theme == "screen" ? draw::Theme::screen : draw::Theme::paper;
    const Shots shots = Shots::film(scene.duration, scene.film.fps, scene.film.speed);
    if (shots.size() == 0) throw UsageError(fmt::format("{}: a film of 0 s has no frames", scene.file));
    PageFilm film(scene, shots);
    double due = kFirstPart;
    while (film.next()) {
      if (interrupted() || saved(flags_.scene) != version) return;
      if (seconds() < due) continue;
      if (film.frames() < shots.size()) server_.show(film.watched());
      due = 2 * seconds();
    }
    if (film.trouble()) throw TroubleError(scene.file, *film.trouble(), "");
    if (interrupted()) return;
    server_.show(film.watched());
    say(stdout, "{}: {} frames in {:.1f} s\n", flags_.scene, film.frames(), seconds());
    std::fflush(stdout);
  }

  const WatchFlags& flags_;
  PageServer& server_;
};

// what no saving of the scene can mend: a rate that is none, values that do not fit a scene that is right
void check_flags(const WatchFlags& flags) {
  if (flags.fps) parse_fps(*flags.fps);
  if (flags.sets.empty()) return;
  try {
    scene::read(flags.scene, {});
  } catch (const scene::Error&) {
    return;  // the page says so, until it is saved anew
  }
  scene::read(flags.scene, flags.sets);
}

int watch(const WatchFlags& flags) {
  if (flags.scene == "-") throw UsageError("watch needs a file that can be saved again");
  std::error_code none;
  if (!fs::exists(flags.scene, none))
    throw media::Error(fmt::format("{}: there is no such file", flags.scene));
  check_flags(flags);
  PageServer server(flags.port);
  server.show(page::words_page(flags.scene, {"simulating ..."}));
  say(stdout, "http://localhost:{}/ shows {}; Ctrl-C ends\n", server.port(), flags.scene);
  std::fflush(stdout);
  Watching watching(flags, server);
  std::jthread making([&] { watching.run(); });
  while (!interrupted()) server.serve();
  return kDone;
}

}  // namespace

OBSCURA_COMMAND(15, watch) {
  const Command command(program, exit, "watch",
                        "Show a scene in a browser while one writes it: a page that follows each save");
  auto flags = std::make_shared<WatchFlags>();
  add_scene(command, flags->scene);
  add_sets(command, flags->sets);
  command
      .option("--port", flags->port, "The port of this machine to serve at [the first free one from 8765 on]")
      .range(1, 65535)
      .type("PORT");
  command.option("--fps", flags->fps, "Frames per second, as 30 or 30000/1001 [film.fps]").type("RATE");
  command.option("--theme", flags->theme, "The look [look.theme]").one_of({"paper", "screen"});
  add_memory_limit(command);
  command.footer(
      "The page is that of `obscura render SCENE -o page.html`, and stays at the same instant and view when "
      "the "
      "scene is saved. A long run is shown as far as it is simulated. Where the scene is wrong, the page has "
      "the "
      "errors with their lines. Only browsers on this machine can see it.\n\n"
      "Examples:\n"
      "  obscura watch scenes/room.toml");
  command.run([flags] { return watch(*flags); });
}

}  // namespace obscura::app
