#include "studies/commands/completion_scripts.h"

#include <fmt/format.h>

#include <algorithm>

#include "studies/commands/setup_keys.h"

namespace gladstone::inline commands {
namespace {

/// Returns the paths of all keys of setups and studies, sorted.
std::vector<std::string> key_paths() {
  std::vector<std::string> paths;
  for (SetupKeyTable const& table : setup_key_tables()) {
    for (SetupKey const& key : table.keys) {
      bool const plain = std::all_of(key.path.begin(), key.path.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '.';
      });
      if (plain) paths.push_back(key.path);
    }
  }
  std::sort(paths.begin(), paths.end());
  paths.erase(std::unique(paths.begin(), paths.end()), paths.end());
  return paths;
}

/// Shortens a description to its first clause, for a line of a list.
std::string first_clause(std::string const& text) {
  std::size_t end = text.size();
  for (char const* stop : {"; ", ": ", " (", ". "}) end = std::min(end, text.find(stop));
  return text.substr(0, end);
}

/// Quotes a text for a shell, in single quotes.
std::string quoted(std::string const& text) {
  std::string result = "'";
  for (char c : text) result += c == '\'' ? "'\\''" : std::string(1, c);
  return result + '\'';
}

std::vector<std::string> names_of(std::vector<CommandDescription> const& commands) {
  std::vector<std::string> names;
  for (CommandDescription const& one : commands) names.push_back(one.name());
  return names;
}

std::vector<std::string> names_of(std::vector<ArgumentDescription> const& options) {
  std::vector<std::string> names;
  for (ArgumentDescription const& one : options) names.insert(names.end(), one.names.begin(), one.names.end());
  return names;
}

// bash

/// Joins patterns of a case statement: 'init -o'|'init --output'. An option of the program is valid in all commands.
std::string case_patterns(CommandDescription const& command, std::vector<std::string> const& names) {
  std::vector<std::string> patterns;
  for (std::string const& name : names)
    patterns.push_back(fmt::format("{}{}", command.path.empty() ? "*" : "", quoted(command.path + ' ' + name)));
  return fmt::format("{}", fmt::join(patterns, "|"));
}

/// Returns the lines that set the words which can follow a command.
std::string bash_command(CommandDescription const& command, std::vector<std::string> const& global_options) {
  std::vector<std::string> words = names_of(command.commands), options = names_of(command.options);
  if (!command.arguments.empty()) words = command.arguments.front().choices;
  if (!command.path.empty()) options.insert(options.end(), global_options.begin(), global_options.end());
  bool const lists_keys = !command.arguments.empty() && takes_setup_key(command, command.arguments.front());
  return fmt::format("    {}) words={} options='{}' ;;\n", quoted(command.path),
                     lists_keys ? "$(_gladstone_setup_keys)" : fmt::format("'{}'", fmt::join(words, " ")),
                     fmt::join(options, " "));
}

/// Returns the lines that set the values of a command's options.
std::string bash_values(CommandDescription const& command) {
  std::string text;
  for (ArgumentDescription const& option : command.options) {
    if (!option.takes_value) continue;
    bool const is_key = takes_setup_key(command, option);
    text += fmt::format("    {}) {}words={} ;;\n", case_patterns(command, option.names), is_key ? "key=yes " : "",
                        is_key ? "$(_gladstone_setup_keys)" : fmt::format("'{}'", fmt::join(option.choices, " ")));
  }
  return text;
}

// zsh

/// Quotes a text for a specification of _arguments, in which brackets and colons have a meaning.
std::string zsh_text(std::string const& text) {
  std::string result;
  for (char c : first_clause(text)) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') result += '\\';
    result += c;
  }
  return result;
}

std::string function_name(CommandDescription const& command) {
  std::string name = "_gladstone";
  if (!command.path.empty()) name += '_' + command.path;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

/// Returns the part of a specification that completes a value: ":value:(auto cpu cuda)".
std::string zsh_value(CommandDescription const& command, ArgumentDescription const& argument) {
  if (takes_setup_key(command, argument)) return ":key:_gladstone_setup_keys";
  if (!argument.choices.empty()) return fmt::format(":value:({})", fmt::join(argument.choices, " "));
  return ":file:_files";
}

std::string zsh_options(CommandDescription const& command) {
  std::string text;
  for (ArgumentDescription const& option : command.options) {
    for (std::string const& name : option.names) {
      std::string const value = option.takes_value ? zsh_value(command, option) : "";
      bool const joined = option.takes_value && name.starts_with("--");  // --device cpu or --device=cpu
      text += fmt::format(" \\\n    {}",
                          quoted(fmt::format("*{}{}[{}]{}", name, joined ? "=" : "", zsh_text(option.text), value)));
    }
  }
  return text;
}

/// Returns the zsh functions that complete a command: those of its sub-commands, then its own.
std::string zsh_function(CommandDescription const& command, std::string const& global_options) {
  std::string text;
  for (CommandDescription const& one : command.commands) text += zsh_function(one, global_options);
  std::string const options = zsh_options(command) + (command.path.empty() ? "" : global_options);
  text += function_name(command) + "() {\n";
  if (command.commands.empty()) {
    text += "  _arguments" + options;
    if (!command.arguments.empty() &&
        (!command.arguments.front().choices.empty() || takes_setup_key(command, command.arguments.front())))
      text += " \\\n    " + quoted('1' + zsh_value(command, command.arguments.front()));
    return text + " \\\n    '*:file:_files'\n}\n\n";
  }
  text += "  local state line\n  local -a commands\n  commands=(\n";
  for (CommandDescription const& one : command.commands)
    text += "    " + quoted(one.name() + ':' + zsh_text(one.summary)) + '\n';
  text += "  )\n  _arguments -C" + options + " \\\n    '1: :->command' '*:: :->arguments'\n  case $state in\n";
  text += "    command) _describe command commands ;;\n    arguments)\n      case $words[1] in\n";
  for (CommandDescription const& one : command.commands)
    text += fmt::format("        {}) {} ;;\n", one.name(), function_name(one));
  return text + "      esac ;;\n  esac\n}\n\n";
}

// fish

std::string fish_options(CommandDescription const& command, std::string const& condition) {
  std::string text;
  for (ArgumentDescription const& option : command.options) {
    text += "complete -c gladstone" + condition;
    for (std::string const& name : option.names)
      text += name.starts_with("--") ? " -l " + name.substr(2) : (name.size() == 2 ? " -s " : " -o ") + name.substr(1);
    if (takes_setup_key(command, option)) {
      text += " -x -a '(__gladstone_keys)='";
    } else if (!option.choices.empty()) {
      text += fmt::format(" -x -a '{}'", fmt::join(option.choices, " "));
    } else if (option.takes_value) {
      text += " -r -F";
    }
    text += " -d " + quoted(first_clause(option.text)) + '\n';
  }
  return text;
}

/// Returns the fish script's lines for a command and its sub-commands.
std::string fish_command(CommandDescription const& command) {
  std::string const inside = command.path.empty() ? "" : fmt::format(" -n '__gladstone_begins {}'", command.path);
  std::string const directly = fmt::format(" -n '__gladstone_is {}'", command.path);
  std::string text = fish_options(command, inside);
  if (!command.arguments.empty()) {
    ArgumentDescription const& first = command.arguments.front();
    if (takes_setup_key(command, first)) text += "complete -c gladstone -f" + directly + " -a '(__gladstone_keys)'\n";
    if (!first.choices.empty())
      text += fmt::format("complete -c gladstone -f{} -a '{}'\n", directly, fmt::join(first.choices, " "));
  }
  for (CommandDescription const& one : command.commands) {
    text += fmt::format("complete -c gladstone -f{} -a {} -d {}\n", directly, one.name(),
                        quoted(first_clause(one.summary)));
  }
  for (CommandDescription const& one : command.commands) text += fish_command(one);
  return text;
}

}  // namespace

std::string bash_completion(CommandDescription const& program) {
  std::vector<std::string> const global_options = names_of(program.options);
  std::string paths, commands, values;
  for (CommandDescription const* one : all_commands(program)) {
    if (!one->path.empty()) {
      std::string const parent = one->path.substr(0, one->path.size() - one->name().size());
      paths += fmt::format("      {}) command={} ;;\n", quoted(parent.empty() ? ' ' + one->name() : one->path),
                           quoted(one->path));
    }
    commands += bash_command(*one, global_options);
    values += bash_values(*one);
  }
  return fmt::format(R"(# Completion of gladstone in bash, printed by: gladstone completion bash

_gladstone_setup_keys() {{
  echo '{}'
}}

_gladstone() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD-1]}} command='' words='' options='' key='' i
  # bash divides --device=cpu into three words
  if [[ $current == '=' ]]; then
    current=''
  elif [[ $previous == '=' && $COMP_CWORD -gt 1 ]]; then
    previous=${{COMP_WORDS[COMP_CWORD-2]}}
  fi
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "$command ${{COMP_WORDS[i]}}" in
{}    esac
  done
  case $command in
{}  esac
  case "$command $previous" in
{}  esac
  [[ $current == -* ]] && words=$options
  local IFS=$' \t\n'
  COMPREPLY=($(compgen -W "$words" -- "$current"))
  if [[ -n $key ]]; then
    COMPREPLY=("${{COMPREPLY[@]/%/=}}")
    compopt -o nospace 2>/dev/null
  fi
}}

complete -o default -F _gladstone gladstone
)",
                     fmt::join(key_paths(), " "), paths, commands, values);
}

std::string zsh_completion(CommandDescription const& program) {
  return fmt::format(R"(#compdef gladstone
# Completion of gladstone in zsh, printed by: gladstone completion zsh

_gladstone_setup_keys() {{
  local -a keys
  keys=({})
  if [[ $words[1] == keys ]]; then
    compadd -a keys
  else
    compset -P '*=' || compadd -S '=' -a keys
  fi
}}

{}if [[ $funcstack[1] == _gladstone ]]; then
  _gladstone "$@"
else
  compdef _gladstone gladstone
fi
)",
                     fmt::join(key_paths(), " "), zsh_function(program, zsh_options(program)));
}

std::string fish_completion(CommandDescription const& program) {
  return fmt::format(R"(# Completion of gladstone in fish, printed by: gladstone completion fish

function __gladstone_keys
    string split ' ' '{}'
end

# True if the words before the cursor, without options, are these.
function __gladstone_is
    set -l given (string match -v -- '-*' (commandline -opc)[2..-1])
    test "$given" = "$argv"
end

# True if the words before the cursor, without options, begin with these.
function __gladstone_begins
    set -l given (string match -v -- '-*' (commandline -opc)[2..-1])
    set -l start $given[1..(count $argv)]
    test "$start" = "$argv"
end

{})",
                     fmt::join(key_paths(), " "), fish_command(program));
}

}  // namespace gladstone::inline commands
