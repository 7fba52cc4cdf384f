#pragma once

namespace obscura::app {

/// From now on SIGINT, SIGTERM and SIGHUP ask for an end instead of ending; the second one ends at once.
/// SIGPIPE and SIGXFSZ (a file larger than it may be) are left to the writer that meets them.
void heed_interrupts();

/// Somebody has asked for an end. Safe from every thread.
bool interrupted();

/// Thrown where a signal ends a command: exit 130, without a message.
struct Interrupted {};

}  // namespace obscura::app
