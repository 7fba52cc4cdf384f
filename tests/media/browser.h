#pragma once

#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

namespace obscura::media {

/// A Chromium on this system.
inline std::optional<std::string> browser() {
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

/// Runs the browser on page.html in a folder until a line of its console holds "OBSCURA", and gives what
/// follows; or the end of what it said.
inline std::string verdict(const std::string& program, const std::string& folder) {
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
  const auto until = std::chrono::steady_clock::now() + std::chrono::minutes(20);
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

}  // namespace obscura::media
