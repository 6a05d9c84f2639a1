#include "tools/app/cli/command_line.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <charconv>
#include <sstream>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/text.h"
#include "tools/app/cli/completions.h"
#include "tools/app/cli/former_commands.h"
#include "tools/app/cli/screen.h"
#include "tools/app/cli/welcome.h"

namespace leviosim::tools {
namespace {

constexpr const char* kHelp = "help";

std::vector<std::string> names_of(const std::vector<Command>& commands) {
  std::vector<std::string> names;
  for (const Command& command : commands) names.push_back(command.app->get_name());
  return names;
}

std::vector<std::string> options_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// Options stand before their values, so the first unknown option is the fault; else the first
/// word.
const std::string& first_fault(const Arguments& unknown) {
  const auto option = std::find_if(unknown.begin(), unknown.end(),
                                   [](const std::string& word) { return word.rfind('-', 0) == 0; });
  return option == unknown.end() ? unknown.front() : *option;
}

[[noreturn]] void fail_unknown(const std::string& where, const std::string& word,
                               const std::vector<std::string>& options) {
  if (word.rfind('-', 0) != 0)
    throw InputError(fmt::format("{}unexpected argument '{}'", where, word));
  const std::string name = word.substr(0, word.find('='));
  throw InputError(
      fmt::format("{}unknown option '{}'{}", where, name, base::did_you_mean(name, options)));
}

/// CLI11 takes the next word for the value of "--out=", and an empty word for no value.
void refuse_empty_values(const Arguments& words) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool is_option = words[i].rfind("--", 0) == 0;
    if (is_option && words[i].find('=') == words[i].size() - 1)
      throw InputError(
          fmt::format("{}: is empty; expected a value", words[i].substr(0, words[i].size() - 1)));
    if (!words[i].empty()) continue;
    const bool has_name = i > 0 && words[i - 1].rfind('-', 0) == 0;
    throw InputError(
        fmt::format("{}: is empty; expected a value", has_name ? words[i - 1] : "argument ''"));
  }
}

/// CLI11's "--frames: At Most 1 required but received 2" and "--seed: 1 required N missing".
std::string about_count(const CLI::ArgumentMismatch& error) {
  constexpr std::string_view kRequired = " required ";
  constexpr std::string_view kMissing = " missing";
  const std::string text = error.what();
  const std::string name = text.substr(0, text.find(':'));
  if (text.find(": At Most ") != std::string::npos)
    return name + " is given more than once; expected it once";
  const std::size_t at = text.find(kRequired);
  if (at == std::string::npos || !text.ends_with(kMissing)) return text;
  const std::string rest = text.substr(at + kRequired.size());
  return fmt::format("{}: has no value; expected {}", name,
                     rest.substr(0, rest.size() - kMissing.size()));
}

[[noreturn]] void fail_unknown_command(const std::vector<Command>& commands,
                                       const std::string& word) {
  for (const FormerCommand& former : kFormerCommands)
    if (word == former.name)
      throw InputError(
          fmt::format("unknown command '{}'; use '{}' instead", word, former.successor));
  std::vector<std::string> names = names_of(commands);
  names.emplace_back(kHelp);
  throw InputError(fmt::format("unknown command '{}'{}", word, base::did_you_mean(word, names)));
}

[[noreturn]] void fail_without_command(const std::vector<Command>& commands,
                                       const Arguments& unknown, const CLI::App& app) {
  if (unknown.empty())
    throw InputError(fmt::format("expected a command: {}", fmt::join(names_of(commands), ", ")));
  const std::string& word = unknown.front();
  if (word.rfind('-', 0) == 0) fail_unknown("", word, options_of(app));
  fail_unknown_command(commands, word);
}

const Command* command_named(const std::vector<Command>& commands, const std::string& name) {
  const auto it = std::find_if(commands.begin(), commands.end(),
                               [&](const Command& c) { return c.app->get_name() == name; });
  return it == commands.end() ? nullptr : &*it;
}

/// "help run" as "run --help", and "help" as "--help".
Arguments help_as_option(const Arguments& words, const std::vector<Command>& commands) {
  if (words.empty() || words.front() != kHelp) return words;
  if (words.size() == 1) return {"--help"};
  if (command_named(commands, words[1]) == nullptr) fail_unknown_command(commands, words[1]);
  if (words.size() > 2) fail_unknown("help: ", words[2], {});
  return {words[1], "--help"};
}

}  // namespace

void TextOptions::operator()(const std::string& names, std::string& value, const std::string& type,
                             const std::string& help) const {
  CLI::Option* option = command.add_option(names, value, help)->type_name(type);
  if (!group.empty()) option->group(group);
}

void TextOptions::operator()(const std::string& names, std::vector<std::string>& values,
                             const std::string& type, const std::string& help, bool split) const {
  CLI::Option* option =
      command.add_option(names, values, help)->type_name(type)->take_all()->allow_extra_args(false);
  if (!group.empty()) option->group(group);
  if (split) option->delimiter(',');
}

void add_examples(CLI::App& command, const std::vector<std::string>& lines) {
  command.footer(fmt::format("Examples:\n  {}", fmt::join(lines, "\n  ")));
}

int run_command_line(CLI::App& app, const std::vector<Command>& commands, const Arguments& typed) {
  refuse_empty_values(typed);
  if (typed.empty()) {
    print_piece(ScreenPiece::Kind::document, welcome(commands));
    return 0;
  }
  if (typed.size() == 3 && typed[0] == kHelp && typed[1] == "--as") {
    print_piece(ScreenPiece::Kind::document, manual(app, commands, typed[2]));
    return 0;
  }
  const Arguments words = help_as_option(typed, commands);
  // CLI11 would go on to a later word that is a command.
  if (!words.empty() && words.front().front() != '-' &&
      command_named(commands, words.front()) == nullptr)
    fail_unknown_command(commands, words.front());
  // Unknown words are collected instead of refused, so that they can be answered with a suggestion.
  app.allow_extras();
  // One command: after it, a folder may be called "run".
  app.require_subcommand(0, 1);
  for (const Command& command : commands) {
    command.app->allow_extras();
    if (command.app->get_option_no_throw("--all") == nullptr)
      command.app->add_flag_function(
          "--all", [](std::int64_t) {}, "print all lines, instead of a screen of them");
  }
  try {
    app.parse(Arguments(words.rbegin(), words.rend()));  // CLI11 takes vectors back to front
  } catch (const CLI::Success& help_or_version) {
    std::ostringstream text;
    const int status = app.exit(help_or_version, text, text);
    print_piece(ScreenPiece::Kind::document, text.str());
    return status;
  } catch (const CLI::ArgumentMismatch& error) {
    throw InputError(about_count(error));
  } catch (const CLI::ParseError& error) {
    throw InputError(error.what());
  }
  for (const Command& command : commands) {
    if (!app.got_subcommand(command.app)) continue;
    Arguments unknown = command.app->remaining();
    std::erase(unknown, "--");  // what stands behind it was taken
    if (!unknown.empty())
      fail_unknown(command.app->get_name() + ": ", first_fault(unknown), options_of(*command.app));
    if (command.app->count("--all") > 0) show_all_results();
    fit_tables();
    command.run();
    return 0;
  }
  fail_without_command(commands, app.remaining(), app);
}

std::int64_t parse_whole(const std::string& option, const std::string& text, std::int64_t min,
                         std::int64_t max, std::string_view about_max) {
  std::int64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end || value < min || value > max)
    throw InputError(fmt::format("{} '{}': expected a whole number from {} to {}{}", option, text,
                                 min, max, about_max));
  return value;
}

double parse_positive(const std::string& option, const std::string& text) {
  double value = 0;
  if (!base::parse_number(text, value) || !(value > 0))
    throw InputError(fmt::format("{} '{}': expected a number above 0", option, text));
  return value;
}

void require(const CLI::App& command, const std::string& option, const std::string& expected) {
  expect_given(command.get_name(), option, command.count(option) == 0, expected);
}

void expect_given(const std::string& command, const std::string& option, bool is_missing,
                  const std::string& expected) {
  if (is_missing)
    throw InputError(fmt::format("{}: {} is missing; expected {}", command, option, expected));
}

}  // namespace leviosim::tools
