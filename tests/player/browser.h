#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace obscura {

/// A page in a browser, as its reader turns it.
class Browser {
 public:
  using Json = nlohmann::json;
  virtual ~Browser() = default;

  /// Opens a page and waits until it is loaded.
  virtual void open(const std::string& url) = 0;
  /// The value of an expression, waited for where it is a promise. Throws what it throws.
  virtual Json value(const std::string& expression) = 0;
  /// A key, pressed and released: "ArrowLeft", "Home", "n".
  virtual void press(const std::string& key, bool shift = false) = 0;
  /// The mouse, moved to a place of the window, px.
  virtual void point(double x, double y) = 0;
  /// The mouse, pressed at a place and moved to another with its button down.
  virtual void drag(double x, double y, double to_x, double to_y) = 0;
  virtual void wheel(double x, double y, double by) = 0;
  /// Two fingers beside a place, so far from it each, one after another.
  virtual void pinch(double x, double y, std::initializer_list<double> apart) = 0;
  /// What the page said on its console, what it threw, and what it asked of the network besides itself.
  virtual std::vector<std::string> complaints(const std::string& itself) = 0;
};

/// A program beside the tests, ended with this object.
class Child {
 public:
  /// `before`: done by the child, before it becomes the program.
  Child(std::vector<std::string> words, const std::function<void()>& before) {
    pid_ = ::fork();
    if (pid_ == 0) {
      ::setpgid(0, 0);
      before();
      const int quiet = ::open("/dev/null", O_WRONLY);
      ::dup2(quiet, 1), ::dup2(quiet, 2);
      std::vector<char*> arguments;
      for (std::string& word : words) arguments.push_back(word.data());
      arguments.push_back(nullptr);
      ::execvp(words[0].c_str(), arguments.data());
      ::_exit(127);
    }
    ::setpgid(pid_, pid_);
  }
  ~Child() {
    ::kill(-pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

 private:
  pid_t pid_ = -1;
};

}  // namespace obscura
