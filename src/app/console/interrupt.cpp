#include "app/console/interrupt.h"

#include <csignal>
#include <initializer_list>

namespace obscura::app {

namespace {

volatile std::sig_atomic_t asked = 0;

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

bool interrupted() { return asked != 0; }

}  // namespace obscura::app
