// What a command prints on stdout: a screen for people, or, where --json was given, one JSON
// document for programs. Every command that prints results makes one of these, so that --json means
// the same everywhere, and so does --all.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
}

namespace leviosim::tools {

/// A line such as "results: DIR".
struct ShownPath {
  std::string label;
  std::string path;
};

struct Printout {
  /// Lines for people, to which others may be added. They give way where the screen is full, and
  /// several parts each: their first lines stay.
  Printout(std::string lines) : Printout(std::vector<std::string>{std::move(lines)}) {}
  Printout(std::vector<std::string> lines) : parts(std::move(lines)) {}
  /// All of the lines are printed, whatever the screen.
  /// @param whole  nothing may be added to them, such as to a document
  Printout(std::string lines, bool whole) : Printout(std::move(lines)) {
    is_all = true;
    is_whole = whole;
  }

  /// Adds the conclusion, a sentence that begins with "verdict: " or "in short: " and is the first
  /// line of the screen, and command lines to try next, which are its last ones. Both always stay.
  Printout ending(std::string sentence, std::vector<std::string> commands) &&;

  std::vector<std::string> parts;
  bool is_all = false;
  bool is_whole = false;
  std::string conclusion{};
  std::vector<std::string> next{};
  std::string ci_commands{};  ///< lines behind the text that a server of CI obeys
};

/// Declares --json.
void add_json_option(CLI::App& command, bool& json);

/// One document is all that goes to stdout, so it does not go with the text of a check.
/// @param budget  what --budget was given; empty if it was not
/// @throws InputError if both were asked for
void expect_json_or_budget(bool json, const std::string& budget);

/// Shows it at the end of the command: the conclusion, the text, where results are unless the
/// printout is whole, and the next commands.
void print(const Printout& printout, const std::vector<ShownPath>& places = {});

/// What the functions return: `document()` where it was asked for, else `lines()`, which may be a
/// printout. The other one is not computed.
template <class Lines, class Document>
Printout printout(bool json, const Lines& lines, const Document& document) {
  return json ? Printout(document(), true) : Printout(lines());
}

}  // namespace leviosim::tools
