// How commands end: results are put in place, then the report is printed. What fails to be put in
// place costs nobody the report.
#pragma once

#include <exception>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/outputs/output_folder.h"

namespace CLI {
class App;
}

namespace leviosim::tools {

// What a command prints on stdout: a screen for people, or, where --json was given, one JSON document
// for programs. Every command that prints results makes one of these, so that --json means the same
// everywhere, and so does --all.

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

  /// What came out of it and why, in a sentence that begins with "verdict: " or "in short: ": the
  /// first line of the screen. And command lines to try next: its last ones. Both stay.
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

/// A line such as "results: DIR".
struct ShownPath {
  std::string label;
  std::string path;
};

/// Shows it at the end of the command: what came out, the text, where results are unless the
/// printout is whole, and what to do next.
void print(const Printout& printout, const std::vector<ShownPath>& places = {});

/// What the functions return: `document()` where it was asked for, else `lines()`, which may be a
/// printout. The other one is not computed.
template <class Lines, class Document>
Printout printout(bool json, const Lines& lines, const Document& document) {
  return json ? Printout(document(), true) : Printout(lines());
}

/// Writes a folder of results, gives it its name, and prints the report with the line
/// "results: DIR", which a whole printout goes without. @param write  the files
/// @throws InputError, after the report, if the results are not under their name; Interrupted
void publish(outputs::OutputFolder& out, const Printout& report, const std::function<void()>& write,
             const std::string& label = "results");

/// The file of an option; none if the option is empty. @throws InputError if it cannot be written
std::optional<outputs::OutputFile> claimed_file(const outputs::OutputRequest& request);

/// @throws InputError if the second option names the file of the first
void expect_different(const std::optional<outputs::OutputFile>& first, const char* first_option,
                      const std::optional<outputs::OutputFile>& second, const char* option);

struct FileOutput {
  std::optional<outputs::OutputFile>& file;
  std::string bytes;
  std::string label;  ///< of the line after the report, "table"; empty: none
};

/// The same for single files: those that were claimed.
void publish(std::initializer_list<FileOutput> files, const Printout& report);

// Thrown by a command that is done and has printed its results: the program ends with that status,
// which is 1 where a limit that the user set was not met.

class EndsWith : public std::exception {
 public:
  explicit EndsWith(int status) : status_(status) {}
  int status() const { return status_; }
  const char* what() const noexcept override { return "a limit was not met"; }

 private:
  int status_;
};

class LimitNotMet : public EndsWith {
 public:
  LimitNotMet() : EndsWith(1) {}
};

}  // namespace leviosim::tools
