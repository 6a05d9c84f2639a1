// What a command prints on stdout: text for people, or, where --json was given, one JSON document
// for programs. Every command that prints results makes one of these, so that --json means the same
// everywhere.
#pragma once

#include <string>
#include <utility>

namespace CLI {
class App;
}

namespace leviosim::tools {

struct Printout {
  /// Lines for people, to which others may be added.
  Printout(std::string lines) : text(std::move(lines)) {}
  /// @param whole  nothing may be added to it, such as to a document
  Printout(std::string all, bool whole) : text(std::move(all)), is_whole(whole) {}

  std::string text;
  bool is_whole = false;
  std::string ci_commands;  ///< lines behind the text that a server of CI obeys
};

/// Declares --json.
void add_json_option(CLI::App& command, bool& json);

/// One document is all that goes to stdout, so it does not go with the text of a check.
/// @param budget  what --budget was given; empty if it was not
/// @throws InputError if both were asked for
void expect_json_or_budget(bool json, const std::string& budget);

/// Prints it as it is.
void print(const Printout& printout);

/// What the functions return: `document()` where it was asked for, else `lines()`. The other one is
/// not computed.
template <class Lines, class Document>
Printout printout(bool json, const Lines& lines, const Document& document) {
  return json ? Printout(document(), true) : Printout(lines());
}

}  // namespace leviosim::tools
