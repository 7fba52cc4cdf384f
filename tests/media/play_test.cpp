// Plays and seeks our movies in a browser: headless Chromium opens a page of ours, whose script plays each
// movie, seeks about in it, draws it into a canvas and compares pixels with what the file was made of; its
// verdict comes back as a line of the console.

#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "media/movie.h"
#include "media/pictures.h"

namespace obscura::media {
namespace {

std::optional<std::string> browser() {
  const char* path = std::getenv("PATH");
  for (const char* name : {"chromium-headless-shell", "chromium", "chromium-browser", "google-chrome"}) {
    std::string folders = path ? path : "";
    for (std::size_t from = 0, to; from <= folders.size(); from = to + 1) {
      to = std::min(folders.find(':', from), folders.size());
      const std::string file = folders.substr(from, to - from) + "/" + name;
      if (::access(file.c_str(), X_OK) == 0) return file;
    }
  }
  return {};
}

constexpr int kWidth = 320, kHeight = 180, kSeconds = 5;
constexpr std::uint8_t kColours[kSeconds][3] = {
    {230, 159, 0}, {0, 114, 178}, {0, 158, 115}, {204, 121, 167}, {240, 240, 240}};

// On the left the second's colour; on the right a grey that says which frame of the second it is.
Image clock_face(int second, int frame, int frames) {
  Image image{kWidth, kHeight, std::vector<std::uint8_t>(std::size_t(4) * kWidth * kHeight, 255)};
  const std::uint8_t grey = std::uint8_t(20 + 200 * frame / frames);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (int k = 0; k < 3; ++k) image.row(y)[4 * x + k] = x < kWidth / 2 ? kColours[second][k] : grey;
    }
  }
  return image;
}

void write_clock(const std::string& path, int fps, const std::string& preset) {
  MovieSpec spec;
  spec.width = kWidth, spec.height = kHeight, spec.fps_num = fps, spec.preset = preset;
  MovieWriter writer(path, spec);
  for (int second = 0; second < kSeconds; ++second) {
    SegmentEncoder encoder(path, spec);
    for (int frame = 0; frame < fps; ++frame) encoder.add(clock_face(second, frame, fps));
    writer.add(encoder.finish());
  }
  writer.close();
}

constexpr const char* kPage = R"html(<!doctype html><meta charset="utf-8"><canvas id="c"></canvas><script>
const colours = [[230,159,0],[0,114,178],[0,158,115],[204,121,167],[240,240,240]];
const movies = [["quick.mp4", 30], ["medium.mp4", 60]];
const canvas = document.getElementById("c"), wrong = [];
let looked = 0;
const say = (verdict) => console.log("OBSCURA " + verdict);
const event = (video, name) => new Promise((resolve, reject) => {
  video.addEventListener(name, resolve, {once: true});
  video.addEventListener("error", () => reject(new Error(video.error ? video.error.message : "error")), {once: true});
});
function pixel(video, x) {
  canvas.width = video.videoWidth; canvas.height = video.videoHeight;
  const context = canvas.getContext("2d", {willReadFrequently: true});
  context.drawImage(video, 0, 0);
  return [...context.getImageData(x, 90, 1, 1).data].slice(0, 3);
}
function look(video, name, fps, time) {
  const second = Math.floor(time), frame = Math.floor((time - second) * fps + 1e-6);
  const grey = 20 + Math.floor(200 * frame / fps);
  // the encoder's quantiser costs saturated colours some levels of blue; the second is told by far more. The grey is
  // luma alone, and differs by three or six from frame to frame
  const compare = (what, got, want, within) => {
    ++looked;
    if (got.some((v, k) => Math.abs(v - want[k]) > within)) wrong.push(`${name} at ${time}: ${what} ${got}, not ${want}`);
  };
  compare("colour", pixel(video, 80), colours[second], 12);
  compare("grey", pixel(video, 240), [grey, grey, grey], fps == 30 ? 3 : 1.5);
}
// seeks, and waits until the frame there is shown: "seeked" may come before it
async function seek(video, name, fps, time) {
  const shown = new Promise((resolve) => {
    const late = setTimeout(() => { wrong.push(`${name} at ${time}: the frame is not shown`); resolve(); }, 10000);
    const step = (now, frame) => {
      if (Math.abs(frame.mediaTime + 0.5 / fps - time) < 0.1 / fps) { clearTimeout(late); resolve(); }
      else video.requestVideoFrameCallback(step);
    };
    video.requestVideoFrameCallback(step);
  });
  const done = event(video, "seeked");
  video.currentTime = time;
  await done;
  await shown;
}
async function watch(name, fps) {
  const video = document.createElement("video");
  video.muted = true; video.preload = "auto"; video.src = name;
  document.body.append(video);
  await event(video, "canplaythrough");
  if (video.videoWidth != 320 || video.videoHeight != 180) wrong.push(`${name}: ${video.videoWidth} x ${video.videoHeight}`);
  if (Math.abs(video.duration - 5) > 1e-3) wrong.push(`${name}: lasts ${video.duration} s`);
  await video.play();
  await new Promise((resolve) => { const id = setInterval(() => { if (video.currentTime > 0.4) { clearInterval(id); resolve(); } }, 20); });
  video.pause();
  // the middle of frames: forth, back, the first and the last
  for (const [second, frame] of [[3, fps / 2], [1, fps - 1], [4, fps - 1], [0, 0], [2, 1], [4, 0]]) {
    const time = second + (frame + 0.5) / fps;
    await seek(video, name, fps, time);
    look(video, name, fps, time);
  }
  video.currentTime = 4.8;
  await event(video, "seeked");
  const ended = event(video, "ended");
  await video.play();
  await ended;
}
(async () => {
  try {
    for (const [name, fps] of movies) await watch(name, fps);
    say(wrong.length ? "FAIL " + wrong.join("; ") : `PASS ${looked} pixels`);
  } catch (error) { say("FAIL " + error + " " + wrong.join("; ")); }
})();
</script>)html";

// Runs the browser on a page until a line of its output holds "OBSCURA", and gives what follows; or the end
// of what it said.
std::string verdict(const std::string& program, const std::string& folder) {
  int ends[2];
  if (::pipe(ends) != 0) return "no pipe";
  const std::string profile = "--user-data-dir=" + folder + "/profile",
                    page = "file://" + folder + "/page.html";
  std::vector<std::string> words = {program,
                                    "--headless",
                                    "--no-sandbox",
                                    "--disable-gpu",
                                    "--disable-quic",
                                    "--no-first-run",
                                    "--disable-background-networking",
                                    "--disable-component-update",
                                    "--disable-sync",
                                    "--disable-dev-shm-usage",
                                    "--disable-extensions",
                                    "--autoplay-policy=no-user-gesture-required",
                                    "--allow-file-access-from-files",
                                    "--mute-audio",
                                    "--enable-logging=stderr",
                                    profile,
                                    page};
  const pid_t child = ::fork();
  if (child == 0) {
    ::setpgid(0, 0);
    ::setenv("HOME", folder.c_str(), 1);
    ::dup2(ends[1], 1);
    ::dup2(ends[1], 2);
    ::close(ends[0]);
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    ::execv(program.c_str(), arguments.data());
    ::_exit(127);
  }
  ::setpgid(child, child);
  ::close(ends[1]);

  std::string said, result;
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(120);
  while (result.empty() && std::chrono::steady_clock::now() < until) {
    pollfd reading{ends[0], POLLIN, 0};
    if (::poll(&reading, 1, 500) == 0) continue;
    char some[4096];
    const ssize_t n = ::read(ends[0], some, sizeof some);
    if (n <= 0) break;
    said.append(some, std::size_t(n));
    const std::size_t at = said.find("\"OBSCURA "), end = said.find('\n', at == said.npos ? 0 : at);
    if (at != said.npos && end != said.npos) result = said.substr(at + 9, end - at - 9);
  }
  ::close(ends[0]);
  ::kill(-child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  return result.empty() ? "no verdict; it said: " + said.substr(said.size() > 3000 ? said.size() - 3000 : 0)
                        : result;
}

TEST(Play, ChromiumPlaysAndSeeksOurMoviesToTheFrame) {
  const auto program = browser();
  if (!program) GTEST_SKIP() << "no Chromium on this system: apt-get install chromium-headless-shell";
  Folder folder;
  write_clock(folder / "quick.mp4", 30, "");
  write_clock(folder / "medium.mp4", 60, "medium");
  std::ofstream(folder / "page.html") << kPage;
  const std::string said = verdict(*program, folder.path);
  EXPECT_EQ(said.substr(0, 4), "PASS") << said;
}

}  // namespace
}  // namespace obscura::media
