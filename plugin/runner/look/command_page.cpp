// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "runner/command.hpp"
#include "runner/look/component_page.hpp"

/// What shells and manuals say of the command, made from the tree that its arguments are parsed by.
namespace hexaplast::runner {
namespace {

std::vector<const CLI::App*> subcommands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

/// Options with a name; those that stand by their place alone are no options, and some are the program's own.
std::vector<const CLI::Option*> options_of(const CLI::App& app) {
  return app.get_options(
      [](const CLI::Option* option) { return option->nonpositional() && !option->get_group().empty(); });
}

std::vector<const CLI::Option*> arguments_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return option->get_positional(); });
}

/// What an option takes, without the conditions that CLI11 appends.
std::string type_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  return type.substr(0, type.find(':'));
}

bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

/// Whether a program of its own takes the command line: it knows the options.
bool is_program(const CLI::App& command) {
  return command.get_parent() && subcommands_of(command).empty() && arguments_of(command).empty() &&
         options_of(command).size() == 1;  // --help
}

// ---- the manual page

/// Text as man's macros take it: no line is mistaken for a macro, and a hyphen is one that can be copied.
std::string roff(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '\\')
      safe += "\\e";
    else if (c == '-')
      safe += "\\-";
    else if ((c == '.' || c == '\'') && (safe.empty() || safe.back() == '\n'))
      safe += std::string("\\&") + c;
    else
      safe += c;
  }
  return safe;
}

void add_entry(const CLI::Option& option, std::string& page) {
  page += ".TP\n";
  std::string separator;
  for (const std::string& name : names_of(option)) {
    page += fmt::format("{}\\fB{}\\fR", separator, roff(name));
    separator = ", ";
  }
  if (takes_value(option)) page += fmt::format(" \\fI{}\\fR", roff(type_of(option)));
  page += fmt::format("\n{}\n", roff(option.get_description()));
}

void add_command(const CLI::App& command, const std::string& path, std::string& page) {
  for (const CLI::App* inner : subcommands_of(command)) {
    const std::string inner_path = fmt::format("{} {}", path, inner->get_name());
    std::string synopsis;
    for (const CLI::Option* argument : arguments_of(*inner)) {
      const std::string name = fmt::format("\\fI{}\\fR", roff(type_of(*argument)));
      synopsis += argument->get_required() ? " " + name : fmt::format(" [{}]", name);
    }
    const bool is_group = !subcommands_of(*inner).empty();
    page += fmt::format(".SS \"{}\"\n\\fB{}\\fR{}{}\n.PP\n{}.\n", roff(inner_path), roff(inner_path), synopsis,
                        is_group ? " \\fICOMMAND\\fR" : " [\\fIOPTION\\fR...]", roff(inner->get_description()));
    for (const CLI::Option* argument : arguments_of(*inner))
      page += fmt::format(".TP\n\\fI{}\\fR\n{}\n", roff(type_of(*argument)), roff(argument->get_description()));
    for (const CLI::Option* option : options_of(*inner)) add_entry(*option, page);
    if (is_program(*inner)) page += fmt::format(".PP\n\\fB{} \\-\\-help\\fR lists its options.\n", roff(inner_path));
    add_command(*inner, inner_path, page);
  }
}

// ---- completion

/// What follows an option or stands by its place: words to choose from, files, or nothing that could be known.
std::string values_of(const CLI::Option& option, const std::string& components) {
  const std::string type = type_of(option);
  if (type == "COMPONENT") return components;
  const bool is_choice = type.find('|') != std::string::npos &&
                         type.find_first_not_of("abcdefghijklmnopqrstuvwxyz|-_0123456789") == std::string::npos;
  if (is_choice) {
    std::string words = type;
    std::replace(words.begin(), words.end(), '|', ' ');
    return words;
  }
  for (const char* kind : {"FILE", "SCENE", "SURFACE", "DIR"})
    if (type.find(kind) != std::string::npos) return kind == std::string("DIR") ? "@directories" : "@files";
  return "";
}

void add_cases(const CLI::App& command, const std::string& path, const std::string& components, std::string& script) {
  std::string commands, options, values, places;
  for (const CLI::App* inner : subcommands_of(command)) commands += inner->get_name() + " ";
  for (const CLI::Option* option : options_of(command)) {
    std::string names;
    for (const std::string& name : names_of(*option)) {
      options += name + " ";
      names += (names.empty() ? "" : "|") + name;
    }
    if (takes_value(*option))
      values += fmt::format("        {}) values='{}' ;;\n", names, values_of(*option, components));
  }
  for (const CLI::Option* argument : arguments_of(command)) places = values_of(*argument, components);
  script += fmt::format(
      "    '{}')\n"
      "      commands='{}' options='{}' places='{}'\n",
      path, commands, options, places);
  if (is_program(command))
    script += fmt::format(
        "      options=$(\"${{COMP_WORDS[0]}}\" {} --help 2>/dev/null | grep -o -- '--[a-z-]*' | sort -u) "
        "places='@files'\n",
        path);
  if (!values.empty()) script += fmt::format("      case $previous in\n{}      esac\n", values);
  script += "      ;;\n";
  for (const CLI::App* inner : subcommands_of(command))
    add_cases(*inner, path.empty() ? inner->get_name() : path + " " + inner->get_name(), components, script);
}

/// Manual page hexaplast(1) in man's macros: every subcommand with all its options.
std::string man_page(const CLI::App& app, const std::string& version) {
  std::string page = fmt::format(
      ".TH HEXAPLAST 1 \"\" \"Hexaplast {0}\" \"User Commands\"\n"
      ".SH NAME\nhexaplast \\- {1}\n"
      ".SH SYNOPSIS\n\\fBhexaplast\\fR \\fICOMMAND\\fR [\\fIARGUMENT\\fR...]\n"
      ".SH DESCRIPTION\nBodies of hexahedra that stretch, yield and stay stretched. Scenes are XML files in SOFA's "
      "grammar, "
      "read strictly.\n",
      version, roff("hexahedral corotational elastoplastic finite elements in real time"));
  page += ".SH OPTIONS\n";
  for (const CLI::Option* option : options_of(app)) add_entry(*option, page);
  page += ".SH COMMANDS\n";
  add_command(app, "hexaplast", page);
  page +=
      ".SH EXIT STATUS\n"
      ".TP\n0\ndone\n.TP\n2\nthe command line means nothing\n.TP\n3\nthe scene, the mesh or the input is rejected\n"
      ".TP\n4\nthe computation failed\n.TP\n5\na file cannot be read or written\n.TP\n6\na plugin cannot be used\n"
      ".TP\n130, 143\nended by SIGINT or SIGTERM after the current step\n";
  return page;
}

/// Completion for bash: subcommands, options, and their values where they are a choice of words, a file, or one of the
/// components.
std::string bash_completion(const CLI::App& app, const std::string& components) {
  std::string cases;
  add_cases(app, "", components, cases);
  return "# bash completion for hexaplast\n"
         "_hexaplast() {\n"
         "  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]}\n"
         "  local path='' word commands='' options='' places='' values='none'\n"
         "\n"
         "  # the subcommand that the cursor is in\n"
         "  for word in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n"
         "    _hexaplast_words \"$path\"\n"
         "    [[ \" $commands\" == *\" $word \"* ]] && path=\"${path:+$path }$word\"\n"
         "  done\n"
         "  values='none'\n"
         "  _hexaplast_words \"$path\"\n"
         "\n"
         "  COMPREPLY=()\n"
         "  local choice=$values\n"
         "  if [[ $values == none ]]; then\n"
         "    choice=$commands$places\n"
         "    [[ $current == -* ]] && choice=$options\n"
         "  fi\n"
         "  case $choice in\n"
         "    @files) compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -f -- \"$current\") ;;\n"
         "    @directories) compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -d -- \"$current\") ;;\n"
         "    *) mapfile -t COMPREPLY < <(compgen -W \"$choice\" -- \"$current\") ;;\n"
         "  esac\n"
         "}\n"
         "\n"
         "# Sets what may follow within a subcommand: commands, options, places, and values after $previous.\n"
         "_hexaplast_words() {\n"
         "  case $1 in\n" +
         cases +
         "  esac\n"
         "}\n"
         "complete -F _hexaplast hexaplast\n";
}

}  // namespace

void add_page(CLI::App& app, Call& call) {
  const auto format = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("page", "Print the manual page, or completion for bash")->group("");
  command->add_option("format", *format, "man or bash")->check(CLI::IsMember({"man", "bash"}))->required();
  command->callback([&app, format, &call] {
    call.exit_code = report_errors("hexaplast", [&] {
      if (*format == "man") return fmt::print("{}", man_page(app, HEXAPLAST_VERSION));
      std::vector<std::string_view> components;
      for (const attributes::Description* component : known_components()) components.push_back(component->class_name);
      fmt::print("{}", bash_completion(app, fmt::format("{}", fmt::join(components, " "))));
    });
  });
}

}  // namespace hexaplast::runner
