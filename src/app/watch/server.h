#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

namespace obscura::app {

/// One page for the browsers of this machine: GET / is the page, GET /changes a stream that tells its version
/// whenever it changes (server-sent events). Answers nothing else, and only requests to
/// localhost by that name.
class PageServer {
 public:
  /// Listens on 127.0.0.1. `port` 0: the first free one from kFirstPort on. Throws media::Error where it is
  /// taken.
  explicit PageServer(int port);
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  static constexpr int kFirstPort = 8765;
  int port() const { return port_; }

  /// Puts another page in the place of the last. From every thread.
  void show(std::string page);

  /// Answers what comes within a tenth of a second.
  void serve();

 private:
  struct Caller {
    int socket = -1;
    std::string said;
    bool listens = false;    // to changes
    std::int64_t told = -1;  // the version that it knows
  };
  bool answer(Caller& caller);
  void reply(Caller& caller, const char* status, const char* type, const std::string& body) const;

  int socket_ = -1, port_ = 0;
  std::vector<Caller> callers_;
  std::mutex mutex_;
  std::string page_;
  std::int64_t version_ = 0;
};

}  // namespace obscura::app
