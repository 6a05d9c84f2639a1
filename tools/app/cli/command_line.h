// The command line of leviosim: subcommands with their options, and messages for mistyped ones.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
}

namespace leviosim::tools {

/// A subcommand after its options have been declared.
struct Command {
  CLI::App* app = nullptr;
  std::function<void()> run;  ///< with the options as parsed
  bool goes_on = false;       ///< the same command resumes after an interruption
};

/// Declares options that take text: names, variable, how the help shows the value, help text. Those
/// of lists are repeatable. @param split  whether values of a list may be one word, "1,2,3"
struct TextOptions {
  CLI::App& command;
  std::string group{};  ///< heading in the help

  void operator()(const std::string& names, std::string& value, const std::string& type,
                  const std::string& help) const;
  void operator()(const std::string& names, std::vector<std::string>& values,
                  const std::string& type, const std::string& help, bool split = false) const;
};

/// Puts command lines at the end of the command's help. All work as they stand in one folder: those
/// of synth, of run, and then of the other commands in the order in which the program lists them
/// (tests/system/examples_test.cpp).
void add_examples(CLI::App& command, const std::vector<std::string>& lines);

/// The words of a command line, without the name of the program.
using Arguments = std::vector<std::string>;

/// Parses the words and runs the command they name. "help COMMAND" is "COMMAND --help".
/// @returns the exit status: 0 also where only help or version was asked for
/// @throws InputError for anything that is not understood, with the nearest valid name
int run_command_line(CLI::App& app, const std::vector<Command>& commands, const Arguments& typed);

/// Option checks: the text of an option, or InputError "--name 'text': expected …".
/// @param about_max  says where the greatest number comes from, after it
std::int64_t parse_whole(const std::string& option, const std::string& text, std::int64_t min,
                         std::int64_t max, std::string_view about_max = {});
double parse_positive(const std::string& option, const std::string& text);
/// @throws InputError if the option was not given
void require(const CLI::App& command, const std::string& option, const std::string& expected);
/// The same where the value says whether it was.
void expect_given(const std::string& command, const std::string& option, bool is_missing,
                  const std::string& expected);

}  // namespace leviosim::tools
