// Pictures and films of the interface: those of `obscura render`, in threads, after fork, as movies.

#include <sys/wait.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <thread>

#include "media/png.h"
#include "obscura/obscura.h"
#include "where.h"

namespace obscura {
namespace {

namespace fs = std::filesystem;

const std::string kScene = OBSCURA_SOURCE_DIR "/scenes/room.toml";
const FilmOptions kSmall{.width = 160, .height = 90, .fps = "30"};

using Bytes = std::vector<std::uint8_t>;
Bytes bytes(const Frame& frame) { return {frame.pixels.begin(), frame.pixels.end()}; }

std::string contents(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// a folder of its own for each test
class Films : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ =
        fs::temp_directory_path() / ("obscura_" + std::string(test->name()) + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  // an exit status of the program
  int obscura(const std::string& arguments) const {
    const int status =
        std::system((OBSCURA_BINARY " " + arguments + " >" + path("out") + " 2>" + path("err")).c_str());
    return WEXITSTATUS(status);
  }

  fs::path folder_;
};

TEST(Renderer, GivesAwayThePixelsOfAPicture) {
  Renderer renderer(Scene::read(kScene), kSmall);
  EXPECT_TRUE(renderer.take().empty());
  const Frame first = *renderer.next();
  const std::uint8_t* at = first.pixels.data();
  const Bytes shown = bytes(first);
  Bytes mine = renderer.take();
  EXPECT_EQ(mine.data(), at);  // no copy
  EXPECT_TRUE(renderer.take().empty());
  for (int n = 0; n < 9; ++n) renderer.next();
  EXPECT_EQ(mine, shown);
  EXPECT_NE(bytes(*renderer.next()), shown);

  // the next is drawn into the memory of one that is no longer needed
  (void)renderer.take(std::move(mine));
  EXPECT_EQ(renderer.next()->pixels.data(), at);
}

TEST_F(Films, FramesAreThoseOfTheProgram) {
  ASSERT_EQ(
      obscura("render " + kScene + " --size 160x90 --fps 30 --frames 0..4 -o " + path("{frame:02}.png")), 0)
      << contents(path("err"));
  Renderer renderer(Scene::read(kScene), kSmall);
  for (int n = 0; n < 5; ++n) {
    const auto frame = renderer.next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->number, n);
    EXPECT_EQ(bytes(*frame), media::read_png(path("0" + std::to_string(n) + ".png")).image.pixels) << n;
  }
  renderer.rewind();
  EXPECT_EQ(renderer.next()->number, 0);
}

TEST_F(Films, AWorldAndAnInstantAreDrawnAsTheirFrame) {
  const Scene scene = Scene::read(kScene);
  Renderer film(scene, kSmall), worlds(scene, kSmall), instants(scene, kSmall);
  World world(scene);
  for (int n = 0; n < 12; ++n) {
    const auto frame = film.next();
    world.step_to(n / film.fps());
    EXPECT_EQ(bytes(worlds.draw(world)), bytes(*frame)) << n;
    if (n % 4 == 0) {
      EXPECT_EQ(bytes(instants.at(frame->time)), bytes(*frame)) << n;
    }
    EXPECT_EQ(world.hash(), frame->state);
  }
  // earlier again
  film.rewind();
  EXPECT_EQ(bytes(instants.at(0)), bytes(*film.next()));
  World other(Scene::read(OBSCURA_SOURCE_DIR "/scenes/tower.toml"));
  EXPECT_THROW(worlds.draw(other), UsageError);
}

TEST_F(Films, TwoRenderersDrawSideBySide) {
  const Scene scene = Scene::read(kScene);
  std::vector<Bytes> alone;
  {
    Renderer renderer(scene, kSmall);
    for (int n = 0; n < 6; ++n) alone.push_back(bytes(*renderer.next()));
  }
  // in turn in one thread, and each in its own
  Renderer a(scene, kSmall), b(scene, kSmall);
  for (int n = 0; n < 6; ++n) {
    EXPECT_EQ(bytes(*a.next()), alone[std::size_t(n)]);
    EXPECT_EQ(bytes(*b.next()), alone[std::size_t(n)]);
  }
  std::vector<std::vector<Bytes>> made(3);
  {
    std::vector<std::jthread> all;
    for (auto& frames : made)
      all.emplace_back([&] {
        Renderer renderer(scene, kSmall);
        for (int n = 0; n < 6; ++n) frames.push_back(bytes(*renderer.next()));
      });
  }
  for (const auto& frames : made) EXPECT_EQ(frames, alone);
}

TEST_F(Films, AChildDrawsWithARendererOfItsOwn) {
  const Scene scene = Scene::read(kScene);
  Renderer renderer(scene, kSmall);
  const Bytes first = bytes(*renderer.next());
  World world(scene);
  world.step(10);
  const pid_t child = ::fork();
  if (child == 0) {
    ::alarm(300);  // ends what hangs
    int wrong = 0;
    world.step(10);
    try {
      renderer.next();
      wrong |= 1;
    } catch (const UsageError&) {
    }
    Renderer own(scene, kSmall);
    if (bytes(*own.next()) != first) wrong |= 2;
    ::_exit(wrong);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status)) << "signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_TRUE(renderer.next());
}

TEST_F(Films, AMovieTakesFramesAndLeavesNothingUnlessItIsClosed) {
  const Scene scene = Scene::read(kScene);
  Renderer renderer(scene, kSmall);
  {
    Movie movie(path("a.mp4"), renderer);
    for (int n = 0; n < 40; ++n) movie.add(*renderer.next());
    EXPECT_EQ(movie.frames(), 40);
    movie.close();
    EXPECT_THROW(movie.add(*renderer.next()), UsageError);
  }
  EXPECT_EQ(obscura("verify " + path("a.mp4")), 4);
  EXPECT_THAT(contents(path("err")), testing::HasSubstr("nothing to verify"));
  const auto size = fs::file_size(path("a.mp4"));
  EXPECT_GT(size, 1000u);
  fs::remove(path("out")), fs::remove(path("err"));
  {
    Movie movie(path("b.mp4"), renderer);
    movie.add(*renderer.next());
    Frame small;
    small.width = small.height = 2;
    EXPECT_THROW(movie.add(small), UsageError);
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
  EXPECT_THROW(Movie(path("c.avi"), renderer), FileError);
}

TEST_F(Films, AChildThatLetsGoOfAMovieLeavesItToItsParent) {
  const Scene scene = Scene::read(kScene);
  Renderer renderer(scene, kSmall);
  auto movie = std::make_unique<Movie>(path("a.mp4"), renderer);
  for (int n = 0; n < 40; ++n) movie->add(*renderer.next());
  const Bytes black(160 * 90 * 4);
  const pid_t child = ::fork();
  if (child == 0) {
    ::alarm(300);
    int wrong = 0;
    try {
      movie->add({160, 90, black, 0, 0, ""});
      wrong |= 1;
    } catch (const UsageError&) {
    }
    movie.reset();
    ::_exit(wrong);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  movie->add(*renderer.next());
  movie->close();
  EXPECT_GT(fs::file_size(path("a.mp4")), 1000u);
}

TEST_F(Films, AFilmIsThatOfTheProgramByteByByte) {
  const Scene scene = Scene::read(kScene);
  film(scene, path("here.mp4"), {.width = 160, .height = 90, .fps = "30", .to = 0.5});
  ASSERT_EQ(obscura("render " + kScene + " --size 160x90 --fps 30 --to 0.5 -o " + path("there.mp4")), 0);
  EXPECT_TRUE(contents(path("here.mp4")) == contents(path("there.mp4")));
  still(scene, 0.25, path("here.png"), kSmall);
  ASSERT_EQ(obscura("render " + kScene + " --size 160x90 --fps 30 --at 0.25 -o " + path("there.png")), 0);
  EXPECT_TRUE(contents(path("here.png")) == contents(path("there.png")));
}

TEST_F(Films, OfAProgramsForceSaysThatItCannotBeVerified) {
  const Scene scene =
      Scene::read(kScene).with_force("wind", [](const Stage&, const Push& push) { push.forces[0] = 1; });
  film(scene, path("wind.mp4"), {.width = 160, .height = 90, .fps = "30", .to = 0.2});
  EXPECT_EQ(obscura("verify " + path("wind.mp4")), 4);
  EXPECT_THAT(contents(path("err")),
              testing::HasSubstr("cannot be verified: the force 'wind' was computed by a program"));
}

TEST_F(Films, PagesFiguresAndWrongOptionsAreThoseOfTheCommands) {
  const Scene scene = Scene::read(kScene);
  EXPECT_THAT(film_page(scene, {.width = 160, .height = 90, .fps = "10", .to = 0.3}),
              testing::StartsWith("<!doctype html>"));
  const std::string svg = figure_svg(scene, {0.5});
  EXPECT_THAT(svg, testing::HasSubstr("<svg"));
  ASSERT_EQ(obscura("figure " + kScene + " --at 0.5 -o " + path("there.svg")), 0);
  EXPECT_TRUE(svg == contents(path("there.svg")));
  EXPECT_THROW(Renderer(scene, {.fps = "often"}), UsageError);
  EXPECT_THROW(Renderer(scene, {.theme = "pink"}), UsageError);
  EXPECT_THROW(Renderer(scene, {.width = -1}), UsageError);
  EXPECT_THROW(film(scene, path("a.avi"), kSmall), UsageError);
}

}  // namespace
}  // namespace obscura
