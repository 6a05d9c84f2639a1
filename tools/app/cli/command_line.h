// The command line of leviosim: subcommands with their options, and the errors that people make.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

namespace leviosim::tools {

/// A subcommand after its options have been declared.
struct Command {
  CLI::App* app = nullptr;
  std::function<void()> run;  ///< with the options as parsed
};

/// Words of the command line without the program's name.
using Words = std::vector<std::string>;

/// Parses the words and runs the command they name.
/// @returns the exit status: 0 also where only help or version was asked for
/// @throws InputError for anything that is not understood, with the nearest valid name
int run_command_line(CLI::App& app, const std::vector<Command>& commands, const Words& words);

/// Option checks: the text of an option, or InputError "--name 'text': expected …".
std::int64_t parse_whole(const std::string& option, const std::string& text, std::int64_t min,
                         std::int64_t max);
double parse_positive(const std::string& option, const std::string& text);
/// @throws InputError if the option was not given
void require(const CLI::App& command, const std::string& option, const std::string& expected);

}  // namespace leviosim::tools
