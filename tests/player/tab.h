#pragma once

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <deque>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace obscura {

/// A page in a headless Chromium, driven through its DevTools protocol over two pipes.
class Tab {
 public:
  using Json = nlohmann::json;

  Tab(const std::string& program, const std::string& folder, int width, int height) {
    int to[2], from[2];
    if (::pipe(to) != 0 || ::pipe(from) != 0) throw std::runtime_error("no pipe");
    std::vector<std::string> words = {program,
                                      "--headless",
                                      "--no-sandbox",
                                      "--remote-debugging-pipe",
                                      "--user-data-dir=" + folder + "/profile",
                                      "--hide-scrollbars",
                                      "--enable-unsafe-swiftshader",
                                      "--no-first-run",
                                      "--disable-background-networking",
                                      "--disable-component-update",
                                      "--disable-dev-shm-usage",
                                      "--disable-extensions",
                                      "--disable-sync",
                                      "about:blank"};
    child_ = ::fork();
    if (child_ == 0) {
      ::setpgid(0, 0);
      ::setenv("HOME", folder.c_str(), 1);
      // it reads commands from 3 and writes answers to 4
      const int in = ::fcntl(to[0], F_DUPFD, 10), out = ::fcntl(from[1], F_DUPFD, 10);
      ::dup2(in, 3), ::dup2(out, 4);
      const int quiet = ::open("/dev/null", O_WRONLY);
      ::dup2(quiet, 1), ::dup2(quiet, 2);
      std::vector<char*> arguments;
      for (std::string& word : words) arguments.push_back(word.data());
      arguments.push_back(nullptr);
      ::execv(program.c_str(), arguments.data());
      ::_exit(127);
    }
    ::setpgid(child_, child_);
    ::close(to[0]), ::close(from[1]);
    write_ = to[1], read_ = from[0];
    const std::string target = call("Target.createTarget", {{"url", "about:blank"}})["targetId"];
    session_ = call("Target.attachToTarget", {{"targetId", target}, {"flatten", true}})["sessionId"];
    for (const char* domain : {"Page", "Runtime", "Log", "Network"}) call(std::string(domain) + ".enable");
    call("Emulation.setDeviceMetricsOverride",
         {{"width", width}, {"height", height}, {"deviceScaleFactor", 1}, {"mobile", false}});
  }
  ~Tab() {
    ::close(write_), ::close(read_);
    ::kill(-child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
  }
  Tab(const Tab&) = delete;
  Tab& operator=(const Tab&) = delete;

  /// Sends a command and waits for its answer.
  Json call(const std::string& method, const Json& parameters = Json::object()) {
    const int id = ++last_;
    Json message{{"id", id}, {"method", method}, {"params", parameters}};
    if (!session_.empty()) message["sessionId"] = session_;
    const std::string text = message.dump() + '\0';
    for (std::size_t done = 0; done < text.size();) {
      const ssize_t n = ::write(write_, text.data() + done, text.size() - done);
      if (n <= 0) throw std::runtime_error("the browser has gone");
      done += std::size_t(n);
    }
    for (;;) {
      Json answer = receive();
      if (answer.value("id", 0) != id) {
        events_.push_back(std::move(answer));
        continue;
      }
      if (answer.contains("error")) throw std::runtime_error(method + ": " + answer["error"].dump());
      return answer["result"];
    }
  }

  /// Opens a page and waits until it is loaded.
  void open(const std::string& url) {
    call("Page.navigate", {{"url", url}});
    for (;;) {
      for (const Json& each : events_)
        if (each.value("method", "") == "Page.loadEventFired") return;
      events_.push_back(receive());
    }
  }

  /// The value of an expression, waited for where it is a promise. Throws what it throws.
  Json value(const std::string& expression) {
    const Json result = call("Runtime.evaluate",
                             {{"expression", expression}, {"awaitPromise", true}, {"returnByValue", true}});
    if (result.contains("exceptionDetails"))
      throw std::runtime_error(expression + ": " + result["exceptionDetails"].dump());
    return result["result"].value("value", Json());
  }

  /// A key, pressed and released.
  void press(const std::string& key, const std::string& text = {}, int modifiers = 0) {
    Json down{{"type", "keyDown"}, {"key", key}, {"modifiers", modifiers}};
    if (!text.empty()) down["text"] = text;
    call("Input.dispatchKeyEvent", down);
    call("Input.dispatchKeyEvent", {{"type", "keyUp"}, {"key", key}, {"modifiers", modifiers}});
  }

  void mouse(const std::string& type, double x, double y, int buttons = 0) {
    call("Input.dispatchMouseEvent", {{"type", type},
                                      {"x", x},
                                      {"y", y},
                                      {"button", type == "mouseMoved" && buttons == 0 ? "none" : "left"},
                                      {"buttons", buttons},
                                      {"clickCount", type == "mouseMoved" ? 0 : 1}});
  }

  /// A screenshot as PNG, base64.
  std::string screenshot(double width, double height) {
    return call("Page.captureScreenshot",
                {{"format", "png"},
                 {"clip", {{"x", 0}, {"y", 0}, {"width", width}, {"height", height}, {"scale", 1}}}})["data"];
  }

  /// What the page said on its console, what it threw, and what it asked of the network besides itself.
  std::vector<std::string> complaints(const std::string& itself) const {
    std::vector<std::string> all;
    for (const Json& each : events_) {
      const std::string method = each.value("method", "");
      if (method == "Runtime.consoleAPICalled" || method == "Runtime.exceptionThrown" ||
          method == "Log.entryAdded")
        all.push_back(each["params"].dump());
      if (method == "Network.requestWillBeSent" &&
          !each["params"]["request"].value("url", "").starts_with(itself))
        all.push_back(each["params"]["request"].dump());
    }
    return all;
  }

 private:
  Json receive() {
    for (;;) {
      if (const std::size_t end = buffer_.find('\0'); end != buffer_.npos) {
        Json message = Json::parse(buffer_.substr(0, end));
        buffer_.erase(0, end + 1);
        return message;
      }
      pollfd reading{read_, POLLIN, 0};
      if (::poll(&reading, 1, 600'000) <= 0) throw std::runtime_error("the browser says nothing");
      char some[65536];
      const ssize_t n = ::read(read_, some, sizeof some);
      if (n <= 0) throw std::runtime_error("the browser has gone");
      buffer_.append(some, std::size_t(n));
    }
  }

  pid_t child_ = -1;
  int write_ = -1, read_ = -1, last_ = 0;
  std::string session_, buffer_;
  std::deque<Json> events_;
};

}  // namespace obscura
