#pragma once

#include <functional>

namespace obscura::app {

/// From now on SIGINT, SIGTERM and SIGHUP ask for an end instead of ending; the second one ends at once.
/// SIGPIPE and SIGXFSZ (a file larger than it may be) are left to the writer that meets them.
void heed_interrupts();

/// Whether an end has been asked for, by a signal or by this thread's function. Safe from every thread.
bool interrupted();

/// From now on interrupted() asks `stop`, too, in this thread; none: signals alone.
void interrupt_by(std::function<bool()> stop);

/// Thrown where a signal ends a command: exit 130, without a message.
struct Interrupted {};

}  // namespace obscura::app
