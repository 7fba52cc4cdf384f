#include "app/watch/server.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include <fmt/format.h>

#include "media/error.h"

namespace obscura::app {

namespace {

constexpr int kTries = 20;                 // ports, where none is asked for
constexpr std::size_t kMostAsked = 16384;  // bytes of a request
constexpr int kReading = 5000;            // ms until a browser that does not read is let go
constexpr int kTurn = 100;                 // ms

bool send_all(int socket, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = ::send(socket, text.data() + done, text.size() - done, MSG_NOSIGNAL);
    if (n > 0) {
      done += std::size_t(n);
      continue;
    }
    if (n < 0 && errno != EAGAIN && errno != EINTR) return false;
    pollfd writing{socket, POLLOUT, 0};
    if (::poll(&writing, 1, kReading) == 0) return false;
  }
  return true;
}

}  // namespace

PageServer::PageServer(int port) {
  for (int i = 0; i < (port == 0 ? kTries : 1); ++i) {
    socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (socket_ < 0) throw media::Error(fmt::format("no socket: {}", std::strerror(errno)));
    const int yes = 1;
    ::setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    port_ = port == 0 ? kFirstPort + i : port;
    sockaddr_in here{};
    here.sin_family = AF_INET;
    here.sin_port = htons(std::uint16_t(port_));
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::bind(socket_, reinterpret_cast<const sockaddr*>(&here), sizeof here) == 0 &&
        ::listen(socket_, 16) == 0)
      return;
    const int why = errno;
    ::close(socket_);
    if (why != EADDRINUSE || port != 0)
      throw media::Error(
          why == EADDRINUSE
              ? fmt::format("port {} is taken: --port says another, and without it a free one is found",
                            port_)
              : fmt::format("port {}: {}", port_, std::strerror(why)));
  }
  throw media::Error(
      fmt::format("ports {} to {} are taken: --port says another", kFirstPort, kFirstPort + kTries - 1));
}

PageServer::~PageServer() {
  for (const Caller& caller : callers_) ::close(caller.socket);
  ::close(socket_);
}

void PageServer::show(std::string page) {
  const std::lock_guard lock(mutex_);
  ++version_;
  // it knows which it is, and so whether another came meanwhile
  static constexpr std::string_view kMark = " data-watched";
  if (const std::size_t at = page.find(kMark); at != page.npos)
    page.insert(at + kMark.size(), fmt::format("=\"{}\"", version_));
  page_ = std::move(page);
}

void PageServer::reply(Caller& caller, const char* status, const char* type, const std::string& body) const {
  send_all(caller.socket, fmt::format("HTTP/1.1 {}\r\nContent-Type: {}\r\nContent-Length: {}\r\n"
                                      "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\n"
                                      "Connection: close\r\n\r\n",
                                      status, type, body.size()) +
                              body);
}

// whether the caller stays
bool PageServer::answer(Caller& caller) {
  const std::string& said = caller.said;
  const std::string line = said.substr(0, said.find("\r\n"));
  std::string head = said;
  std::transform(head.begin(), head.end(), head.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  // a page of elsewhere that a name leads here has that name
  const auto called = [&](const char* name) {
    return head.find(fmt::format("\r\nhost: {}:{}\r\n", name, port_)) != head.npos;
  };
  if (!called("localhost") && !called("127.0.0.1")) {
    reply(caller, "403 Forbidden", "text/plain", "only as localhost\n");
  } else if (line.starts_with("GET / ") || line.starts_with("GET /?")) {
    std::string page;
    {
      const std::lock_guard lock(mutex_);
      page = page_;
    }
    reply(caller, "200 OK", "text/html; charset=utf-8", page);
  } else if (line.starts_with("GET /changes ")) {
    caller.listens = true;
    return send_all(caller.socket,
                    "HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\nCache-Control: no-store\r\n\r\n");
  } else {
    reply(caller, "404 Not Found", "text/plain", "there is one page here: /\n");
  }
  return false;
}

void PageServer::serve() {
  std::vector<pollfd> all{{socket_, POLLIN, 0}};
  for (const Caller& caller : callers_) all.push_back({caller.socket, POLLIN, 0});
  ::poll(all.data(), all.size(), kTurn);
  for (std::size_t i = 0; i < callers_.size(); ++i) {
    Caller& caller = callers_[i];
    bool stays = true;
    if (all[i + 1].revents) {
      std::array<char, 4096> some;
      const ssize_t n = ::recv(caller.socket, some.data(), some.size(), 0);
      if (n > 0 && !caller.listens) {
        caller.said.append(some.data(), std::size_t(n));
        if (caller.said.find("\r\n\r\n") != std::string::npos)
          stays = answer(caller);
        else
          stays = caller.said.size() < kMostAsked;
      } else {
        stays = n > 0 || (n < 0 && (errno == EAGAIN || errno == EINTR));
      }
    }
    if (stays && caller.listens) {
      std::int64_t version;
      {
        const std::lock_guard lock(mutex_);
        version = version_;
      }
      if (version != caller.told) stays = send_all(caller.socket, fmt::format("data: {}\n\n", version));
      caller.told = version;
    }
    if (!stays) ::close(caller.socket), caller.socket = -1;
  }
  std::erase_if(callers_, [](const Caller& caller) { return caller.socket < 0; });
  if (all[0].revents) {
    const int caller = ::accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (caller >= 0) callers_.push_back({caller, {}, false, -1});
  }
}

}  // namespace obscura::app
