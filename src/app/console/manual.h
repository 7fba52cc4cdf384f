#pragma once

#include <string>

#include "app/console/table.h"

namespace obscura::app {

/// The man page of a command, or of the program where `command` is empty, in the macros of man(7). It is
/// dated by SOURCE_DATE_EPOCH, else not. Throws UsageError where there is no such command.
std::string manual(const CommandTables& tables, const std::string& command);

}  // namespace obscura::app
