#pragma once

#include <string>
#include <string_view>

#include "scene/error.h"

namespace obscura::app::github {

/// An annotation that GitHub shows at a line of a file, on the page of a workflow's run and of its pull
/// request.
struct Annotation {
  enum class Level { error, warning, notice };
  Level level = Level::error;
  std::string file = {};     // as seen from the current folder; empty: of no file
  int line = 0, column = 0;  // from 1; 0: of the file as a whole
  std::string title = {}, message = {};
};

/// Its workflow command, a line: "::error file=a.toml,line=3,title=...::...\n". Its texts cannot form a
/// command of their own: line ends, percent signs and, in properties, colons and commas are escaped.
std::string command(const Annotation& annotation);

/// One for each thing that is wrong with a scene, at its line.
std::string commands(const scene::Error& error);

/// Text of a log in which no line is a workflow command, whatever it says: commands stop before it, and go
/// on after it with a token that cannot be guessed.
std::string verbatim(const std::string& text);

/// A line of text as it stands, in Markdown and in a cell of its tables.
std::string escaped(std::string_view text);

/// Text of several lines as it stands, in a block of its own.
std::string quoted(const std::string& text);

/// Appends Markdown to the summary of the step, the file that GITHUB_STEP_SUMMARY names; without one does
/// nothing. Throws media::Error.
void add_to_summary(const std::string& markdown);

}  // namespace obscura::app::github
