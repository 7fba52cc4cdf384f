#include "app/console/interrupt.h"

#include <csignal>
#include <initializer_list>
#include <utility>

namespace obscura::app {

namespace {

volatile std::sig_atomic_t asked = 0;
thread_local std::function<bool()> also;

void ask(int signal) {
  asked = 1;
  std::signal(signal, SIG_DFL);
}

}  // namespace

void heed_interrupts() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    // a signal that the parent set to ignored (nohup) stays ignored
    if (std::signal(signal, ask) == SIG_IGN) std::signal(signal, SIG_IGN);
  }
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
}

bool interrupted() { return asked != 0 || (also && also()); }

void interrupt_by(std::function<bool()> stop) { also = std::move(stop); }

}  // namespace obscura::app
