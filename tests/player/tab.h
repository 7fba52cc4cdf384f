#pragma once

#include <poll.h>

#include <deque>
#include <map>
#include <memory>
#include <stdexcept>

#include "player/browser.h"

namespace obscura {

/// A page in a headless Chromium, driven through its DevTools protocol over two pipes.
class Tab : public Browser {
 public:
  /// `flag`: one more of the browser; kScrollBars: without the one that hides them.
  static constexpr const char* kScrollBars = "--hide-scrollbars";
  Tab(const std::string& program, const std::string& folder, int width, int height,
      const std::string& flag = {}) {
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
    if (flag == kScrollBars)
      std::erase(words, flag);
    else if (!flag.empty())
      words.insert(words.end() - 1, flag);
    child_ = std::make_unique<Child>(words, [&] {
      ::setenv("HOME", folder.c_str(), 1);
      // it reads commands from 3 and writes answers to 4
      const int in = ::fcntl(to[0], F_DUPFD, 10), out = ::fcntl(from[1], F_DUPFD, 10);
      ::dup2(in, 3), ::dup2(out, 4);
    });
    ::close(to[0]), ::close(from[1]);
    write_ = to[1], read_ = from[0];
    const std::string target = call("Target.createTarget", {{"url", "about:blank"}})["targetId"];
    session_ = call("Target.attachToTarget", {{"targetId", target}, {"flatten", true}})["sessionId"];
    for (const char* domain : {"Page", "Runtime", "Log", "Network"}) call(std::string(domain) + ".enable");
    call("Emulation.setDeviceMetricsOverride",
         {{"width", width}, {"height", height}, {"deviceScaleFactor", 1}, {"mobile", false}});
  }
  ~Tab() override { ::close(write_), ::close(read_); }

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

  void open(const std::string& url) override {
    std::erase_if(events_,
                  [](const Json& each) { return each.value("method", "") == "Page.loadEventFired"; });
    call("Page.navigate", {{"url", url}});
    for (;;) {
      for (const Json& each : events_)
        if (each.value("method", "") == "Page.loadEventFired") return;
      events_.push_back(receive());
    }
  }

  Json value(const std::string& expression) override { return evaluate(expression, Json::object()); }

  /// The same in the newest frame of the page, of whatever origin.
  Json value_in_frame(const std::string& expression) {
    int context = 0;
    for (const Json& each : events_)
      if (each.value("method", "") == "Runtime.executionContextCreated" &&
          each["params"]["context"]["auxData"].value("isDefault", false))
        context = each["params"]["context"]["id"];
    return evaluate(expression, {{"contextId", context}});
  }

  void press(const std::string& key, bool shift = false) override {
    const int modifiers = shift ? 8 : 0;
    Json down{{"type", "keyDown"}, {"key", key}, {"modifiers", modifiers}};
    if (key.size() == 1) down["text"] = key;
    // pages that read the old codes
    static const std::map<std::string, int> kCodes{{"End", 35},     {"Home", 36},       {"ArrowLeft", 37},
                                                   {"ArrowUp", 38}, {"ArrowRight", 39}, {"ArrowDown", 40}};
    if (const auto code = kCodes.find(key); code != kCodes.end())
      down["windowsVirtualKeyCode"] = code->second;
    call("Input.dispatchKeyEvent", down);
    call("Input.dispatchKeyEvent", {{"type", "keyUp"}, {"key", key}, {"modifiers", modifiers}});
  }

  void point(double x, double y) override { mouse("mouseMoved", x, y, 0); }
  void drag(double x, double y, double to_x, double to_y) override {
    mouse("mousePressed", x, y, 1);
    for (const double part : {0.5, 1.0}) mouse("mouseMoved", x + part * (to_x - x), y + part * (to_y - y), 1);
    mouse("mouseReleased", to_x, to_y, 0);
  }
  void wheel(double x, double y, double by) override {
    call("Input.dispatchMouseEvent",
         {{"type", "mouseWheel"}, {"x", x}, {"y", y}, {"deltaX", 0}, {"deltaY", by}});
  }
  void pinch(double x, double y, std::initializer_list<double> apart) override {
    const char* type = "touchStart";
    for (const double off : apart) {
      const Json points = {{{"x", x - off}, {"y", y}, {"id", 1}}, {{"x", x + off}, {"y", y}, {"id", 2}}};
      call("Input.dispatchTouchEvent", {{"type", type}, {"touchPoints", points}});
      type = "touchMove";
    }
    call("Input.dispatchTouchEvent", {{"type", "touchEnd"}, {"touchPoints", Json::array()}});
  }

  /// A screenshot as PNG, base64.
  std::string screenshot(double width, double height) {
    return call("Page.captureScreenshot",
                {{"format", "png"},
                 {"clip", {{"x", 0}, {"y", 0}, {"width", width}, {"height", height}, {"scale", 1}}}})["data"];
  }

  std::vector<std::string> complaints(const std::string& itself) override {
    std::vector<std::string> all;
    for (const Json& each : events_) {
      const std::string method = each.value("method", "");
      if (method == "Runtime.consoleAPICalled" || method == "Runtime.exceptionThrown" ||
          method == "Log.entryAdded") {
        // without a graphics card it says that reading from one is slow
        if (each["params"].dump().find("GL Driver Message") == std::string::npos)
          all.push_back(each["params"].dump());
      }
      if (method == "Network.requestWillBeSent" &&
          !each["params"]["request"].value("url", "").starts_with(itself))
        all.push_back(each["params"]["request"].dump());
    }
    return all;
  }

 private:
  Json evaluate(const std::string& expression, Json parameters) {
    parameters["expression"] = expression;
    parameters["awaitPromise"] = parameters["returnByValue"] = true;
    const Json result = call("Runtime.evaluate", parameters);
    if (result.contains("exceptionDetails"))
      throw std::runtime_error(expression + ": " + result["exceptionDetails"].dump());
    return result["result"].value("value", Json());
  }

  void mouse(const char* type, double x, double y, int buttons) {
    call("Input.dispatchMouseEvent", {{"type", type},
                                      {"x", x},
                                      {"y", y},
                                      {"button", buttons > 0 || type[5] == 'R' ? "left" : "none"},
                                      {"buttons", buttons},
                                      {"clickCount", type[5] == 'M' ? 0 : 1}});
  }

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

  std::unique_ptr<Child> child_;
  int write_ = -1, read_ = -1, last_ = 0;
  std::string session_, buffer_;
  std::deque<Json> events_;
};

}  // namespace obscura
