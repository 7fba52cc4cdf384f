#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <stdexcept>
#include <thread>

#include "player/browser.h"

namespace obscura {

/// A page in Firefox, driven through its Marionette protocol (WebDriver's commands, over a socket) on a
/// display of Xvfb: without one it has no WebGL.
class Firefox : public Browser {
 public:
  Firefox(const std::string& folder, int width, int height) {
    int told[2];
    if (::pipe(told) != 0) throw std::runtime_error("no pipe");
    display_ = std::make_unique<Child>(std::vector<std::string>{"Xvfb", "-displayfd", "3", "-screen", "0",
                                                                "1600x1200x24", "-nolisten", "tcp"},
                                       [&] {
                                         const int out = ::fcntl(told[1], F_DUPFD, 10);
                                         ::dup2(out, 3);
                                       });
    ::close(told[1]);
    std::string number;
    for (char c = 0; ::read(told[0], &c, 1) == 1 && c != '\n';) number += c;
    ::close(told[0]);
    if (number.empty()) throw std::runtime_error("Xvfb has no display");

    static int count = 0;
    const std::string profile = folder + "/firefox" + std::to_string(++count);
    std::filesystem::create_directories(profile);
    std::ofstream(profile + "/user.js") << "user_pref('marionette.port', 0);\n"
                                           "user_pref('webgl.force-enabled', true);\n"
                                           "user_pref('app.update.enabled', false);\n"
                                           "user_pref('datareporting.policy.dataSubmissionEnabled', false);\n"
                                           "user_pref('browser.shell.checkDefaultBrowser', false);\n";
    program_ = std::make_unique<Child>(
        std::vector<std::string>{"firefox-esr", "--marionette", "--remote-allow-system-access", "--no-remote",
                                 "--profile", profile, "about:blank"},
        [&] {
          ::setenv("HOME", folder.c_str(), 1);
          ::setenv("DISPLAY", (":" + number).c_str(), 1);
          ::setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
        });
    // it writes there at which port it listens
    int port = 0;
    for (int i = 0; port == 0 && i < 3000; ++i) {
      if (!(std::ifstream(profile + "/MarionetteActivePort") >> port)) port = 0;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in there{};
    there.sin_family = AF_INET;
    there.sin_port = htons(std::uint16_t(port));
    there.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (port == 0 || ::connect(socket_, reinterpret_cast<const sockaddr*>(&there), sizeof there) != 0)
      throw std::runtime_error("Firefox does not listen");
    receive();
    call("WebDriver:NewSession", {{"capabilities", Json::object()}});
    call("WebDriver:SetTimeouts", {{"script", 600'000}});
    // the window is larger than the page by its bars
    const Json bars = value("[outerWidth - innerWidth, outerHeight - innerHeight]");
    call("WebDriver:SetWindowRect",
         {{"width", width + int(bars[0])}, {"height", height + int(bars[1])}, {"x", 0}, {"y", 0}});
  }
  ~Firefox() override {
    // its own processes end with it
    try {
      call("Marionette:Quit", {{"flags", {"eForceQuit"}}});
    } catch (const std::exception&) {
      // it is killed then
    }
    ::close(socket_);
  }

  void open(const std::string& url) override {
    call("WebDriver:Navigate", {{"url", url}});
    chrome("Services.console.reset()");
  }

  Json value(const std::string& expression) override { return script("return (" + expression + ")"); }

  void press(const std::string& key, bool shift = false) override {
    static const std::map<std::string, std::string> kNamed{{"End", "\uE010"},        {"Home", "\uE011"},
                                                           {"ArrowLeft", "\uE012"},  {"ArrowUp", "\uE013"},
                                                           {"ArrowRight", "\uE014"}, {"ArrowDown", "\uE015"}};
    const auto named = kNamed.find(key);
    const std::string code = named == kNamed.end() ? key : named->second;
    Json all = Json::array();
    const auto add = [&](const char* type, const std::string& what) {
      all.push_back({{"type", type}, {"value", what}});
    };
    if (shift) add("keyDown", "\uE008");
    add("keyDown", code), add("keyUp", code);
    if (shift) add("keyUp", "\uE008");
    act(Json::array({Json{{"type", "key"}, {"id", "keys"}, {"actions", all}}}));
  }

  void point(double x, double y) override {
    act(Json::array({pointer("mouse", "mouse", Json::array({move(x, y)}))}));
  }
  void drag(double x, double y, double to_x, double to_y) override {
    act(Json::array({pointer(
        "mouse", "mouse",
        Json::array({move(x, y), down(), move((x + to_x) / 2, (y + to_y) / 2), move(to_x, to_y), up()}))}));
  }
  void wheel(double x, double y, double by) override {
    const Json scroll{{"type", "scroll"}, {"x", int(x)}, {"y", int(y)}, {"deltaX", 0}, {"deltaY", int(by)}};
    act(Json::array({Json{{"type", "wheel"}, {"id", "wheel"}, {"actions", Json::array({scroll})}}}));
  }
  void pinch(double x, double y, std::initializer_list<double> apart) override {
    Json all = Json::array();
    for (const int side : {-1, 1}) {
      Json moves = Json::array();
      for (const double off : apart) {
        moves.push_back(move(x + side * off, y));
        if (moves.size() == 1) moves.push_back(down());
      }
      moves.push_back(up());
      all.push_back(pointer("touch", side < 0 ? "left" : "right", moves));
    }
    act(all);
  }

  std::vector<std::string> complaints(const std::string& itself) override {
    std::vector<std::string> all;
    const std::string file = itself.substr(0, itself.find('#'));
    for (const Json& each : chrome("return Services.console.getMessageArray().map(String)")) {
      const std::string said = each;
      // what it says of itself is no matter of the page
      if (said.find(file) != said.npos && said.find("WebGL warning: readPixels") == said.npos)
        all.push_back(said);
    }
    for (const Json& each : value("performance.getEntriesByType('resource').map((each) => each.name)"))
      if (!std::string(each).starts_with(itself)) all.push_back(each);
    return all;
  }

 private:
  static Json move(double x, double y) {
    return {{"type", "pointerMove"}, {"x", int(x)}, {"y", int(y)}, {"duration", 0}};
  }
  static Json down() { return {{"type", "pointerDown"}, {"button", 0}}; }
  static Json up() { return {{"type", "pointerUp"}, {"button", 0}}; }
  static Json pointer(const char* kind, const char* id, const Json& actions) {
    return {{"type", "pointer"}, {"id", id}, {"parameters", {{"pointerType", kind}}}, {"actions", actions}};
  }
  void act(const Json& all) { call("WebDriver:PerformActions", {{"actions", all}}); }

  Json script(const std::string& text) {
    const Json found = call("WebDriver:ExecuteAsyncScript",
                            {{"script",
                              "const done = arguments[arguments.length - 1];"
                              "(async () => { " +
                                  text +
                                  "; })().then((value) => done({ value }), (error) => done({ error: "
                                  "`${error}\\n${error && error.stack}` }));"},
                             {"args", Json::array()}})["value"];
    if (found.contains("error")) throw std::runtime_error(text + ": " + std::string(found["error"]));
    return found.value("value", Json());
  }
  Json chrome(const std::string& text) {
    call("Marionette:SetContext", {{"value", "chrome"}});
    const Json found = script(text);
    call("Marionette:SetContext", {{"value", "content"}});
    return found;
  }

  Json call(const std::string& method, const Json& parameters) {
    const std::string body = Json{0, ++last_, method, parameters}.dump();
    const std::string text = std::to_string(body.size()) + ":" + body;
    for (std::size_t done = 0; done < text.size();) {
      const ssize_t n = ::send(socket_, text.data() + done, text.size() - done, MSG_NOSIGNAL);
      if (n <= 0) throw std::runtime_error("Firefox has gone");
      done += std::size_t(n);
    }
    const Json answer = receive();
    if (!answer[2].is_null()) throw std::runtime_error(method + ": " + answer[2].dump());
    return answer[3];
  }

  // a length, a colon, so many bytes
  Json receive() {
    for (;;) {
      const std::size_t colon = buffer_.find(':');
      if (colon != buffer_.npos) {
        const std::size_t size = std::stoul(buffer_.substr(0, colon));
        if (buffer_.size() >= colon + 1 + size) {
          Json message = Json::parse(buffer_.substr(colon + 1, size));
          buffer_.erase(0, colon + 1 + size);
          return message;
        }
      }
      pollfd reading{socket_, POLLIN, 0};
      if (::poll(&reading, 1, 600'000) <= 0) throw std::runtime_error("Firefox says nothing");
      char some[65536];
      const ssize_t n = ::recv(socket_, some, sizeof some, 0);
      if (n <= 0) throw std::runtime_error("Firefox has gone");
      buffer_.append(some, std::size_t(n));
    }
  }

  std::unique_ptr<Child> display_, program_;
  int socket_ = -1, last_ = 0;
  std::string buffer_;
};

}  // namespace obscura
