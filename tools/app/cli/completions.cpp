#include "tools/app/cli/completions.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <array>

#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/cli/version.h"

namespace leviosim::tools {
namespace {

/// An option of a command, or of the program.
struct Entry {
  std::vector<std::string> names;  ///< "-p", "--set"; of what has none, "RUN"
  std::string type;                ///< of its value; empty for flags
  std::string description;

  bool is_positional() const { return names.front().front() != '-'; }
};

std::vector<Entry> entries_of(const CLI::App& app) {
  std::vector<Entry> all;
  for (const CLI::Option* option : app.get_options()) {
    Entry entry{{}, {}, option->get_description()};
    for (const std::string& name : option->get_snames()) entry.names.push_back('-' + name);
    for (const std::string& name : option->get_lnames()) entry.names.push_back("--" + name);
    if (entry.names.empty()) entry.names.push_back(option->get_name(true));
    if (option->get_items_expected_max() > 0) entry.type = option->get_type_name();
    all.push_back(std::move(entry));
  }
  return all;
}

std::vector<std::string> options_of_shell(const CLI::App& app) {
  std::vector<std::string> words;
  for (const Entry& entry : entries_of(app))
    if (!entry.is_positional()) words.insert(words.end(), entry.names.begin(), entry.names.end());
  return words;
}

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

/// Text in a manual page: no line begins with a request, and hyphens are what is typed.
std::string roff(const std::string& text) {
  std::string out = replaced(replaced(text, "\\", "\\e"), "-", "\\-");
  if (!out.empty() && (out.front() == '.' || out.front() == '\'')) out.insert(0, "\\&");
  return replaced(replaced(out, "\n.", "\n\\&."), "\n'", "\n\\&'");
}

/// Text within '…' of a shell, where nothing else is special.
std::string quoted(const std::string& text) { return '\'' + replaced(text, "'", "'\\''") + '\''; }

std::string roff_entries(const CLI::App& app) {
  std::string text;
  for (const Entry& entry : entries_of(app))
    text += fmt::format(
        ".TP\n\\fB{}\\fR{}\n{}\n", roff(fmt::format("{}", fmt::join(entry.names, ", "))),
        entry.type.empty() ? "" : " \\fI" + roff(entry.type) + "\\fR", roff(entry.description));
  return text;
}

std::string man_page(const CLI::App& app, const std::vector<Command>& commands) {
  std::string text = fmt::format(
      ".TH LEVIOSIM 1 \"\" \"leviosim {}\"\n.SH NAME\nleviosim \\- {}\n.SH "
      "SYNOPSIS\n\\fBleviosim\\fR "
      "\\fICOMMAND\\fR [\\fIOPTIONS\\fR]\n.SH OPTIONS\n{}.SH COMMANDS\n",
      version(), roff(app.get_description()), roff_entries(app));
  for (const Command& command : commands)
    text += fmt::format(".SS leviosim {}\n{}.\n{}.PP\n.nf\n{}\n.fi\n", command.app->get_name(),
                        roff(command.app->get_description()), roff_entries(*command.app),
                        roff(command.app->get_footer()));
  return text +
         ".SH EXIT STATUS\n0 if done, 1 if a limit that the user set was not met, 2 for bad input, "
         "with one message on stderr, 130 and 143 if interrupted.\n";
}

std::string bash_completion(const CLI::App& app, const std::vector<Command>& commands) {
  std::vector<std::string> names;
  std::string cases;
  for (const Command& command : commands) {
    names.push_back(command.app->get_name());
    cases += fmt::format("    {}) words='{}' ;;\n", command.app->get_name(),
                         fmt::join(options_of_shell(*command.app), " "));
  }
  return fmt::format(
      "_leviosim() {{\n"
      "  local word=${{COMP_WORDS[COMP_CWORD]}} words=\n"
      "  if ((COMP_CWORD == 1)); then\n"
      "    words='help {} {}'\n"
      "  elif [[ $word == -* ]]; then\n"
      "    case ${{COMP_WORDS[1]}} in\n{}    esac\n"
      "  elif [[ ${{COMP_WORDS[1]}} == help ]]; then\n"
      "    words='{}'\n"
      "  fi\n"
      "  if [[ -n $words ]]; then\n"
      "    mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\")\n"
      "  else\n"
      "    mapfile -t COMPREPLY < <(compgen -f -- \"$word\")\n"
      "  fi\n"
      "}}\n"
      "complete -o filenames -F _leviosim leviosim\n",
      fmt::join(names, " "), fmt::join(options_of_shell(app), " "), cases, fmt::join(names, " "));
}

/// A specification of _arguments: "--out[folder for the results]:DIR:_files".
std::string zsh_argument(const std::string& name, const Entry& entry) {
  const auto plain = [](const std::string& text) {
    std::string out = text;
    for (const char* special : {"\\", "[", "]", ":"})
      out = replaced(out, special, std::string("\\") + special);
    return out;
  };
  return quoted(fmt::format("*{}[{}]{}", name, plain(entry.description),
                            entry.type.empty() ? "" : ":" + plain(entry.type) + ":_files"));
}

std::string zsh_completion(const CLI::App&, const std::vector<Command>& commands) {
  std::string names, cases;
  for (const Command& command : commands) {
    names += "  " +
             quoted(replaced(command.app->get_name(), ":", "\\:") + ':' +
                    command.app->get_description()) +
             '\n';
    cases += fmt::format("  {})\n    _arguments", command.app->get_name());
    for (const Entry& entry : entries_of(*command.app)) {
      if (entry.is_positional()) continue;
      for (const std::string& name : entry.names)
        cases += " \\\n      " + zsh_argument(name, entry);
    }
    cases += " \\\n      '*:file:_files'\n    ;;\n";
  }
  return fmt::format(
      "#compdef leviosim\nlocal -a commands\ncommands=(\n{})\nif ((CURRENT == 2)); then\n  "
      "_describe command "
      "commands\n  return\nfi\nlocal command=$words[2]\nshift words\n((CURRENT--))\ncase $command "
      "in\n{}esac\n",
      names, cases);
}

std::string fish_completion(const CLI::App&, const std::vector<Command>& commands) {
  std::string text;
  for (const Command& command : commands) {
    const std::string name = command.app->get_name();
    text += fmt::format("complete -c leviosim -n __fish_use_subcommand -a {} -d {}\n", name,
                        quoted(command.app->get_description()));
    for (const Entry& entry : entries_of(*command.app)) {
      if (entry.is_positional()) continue;
      text += fmt::format("complete -c leviosim -n '__fish_seen_subcommand_from {}'", name);
      for (const std::string& word : entry.names)
        text += word.starts_with("--") ? " -l " + word.substr(2) : " -s " + word.substr(1);
      text += fmt::format(" -d {}{}\n", quoted(entry.description), entry.type.empty() ? "" : " -r");
    }
  }
  return text;
}

struct Format {
  std::string_view name;
  std::string (*text)(const CLI::App&, const std::vector<Command>&);
};

constexpr std::array kFormats{Format{"man", man_page}, Format{"bash", bash_completion},
                              Format{"zsh", zsh_completion}, Format{"fish", fish_completion}};

}  // namespace

std::string manual(const CLI::App& app, const std::vector<Command>& commands,
                   const std::string& format) {
  std::vector<std::string> names;
  for (const Format& known : kFormats) {
    if (known.name == format) return known.text(app, commands);
    names.emplace_back(known.name);
  }
  throw InputError(fmt::format("help --as '{}': expected {}{}", format, fmt::join(names, ", "),
                               base::did_you_mean(format, names)));
}

}  // namespace leviosim::tools
