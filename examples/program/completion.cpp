#include "completion.hpp"

#include <algorithm>
#include <vector>

#include "options.hpp"

namespace dcem::program {
namespace {

/// Commands that the help lists.
std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

std::vector<const CLI::Option*> options_of(const CLI::App& command) {
  return command.get_options([](const CLI::Option* option) { return !option->get_positional(); });
}

std::vector<const CLI::Option*> positionals_of(const CLI::App& command) {
  return command.get_options([](const CLI::Option* option) { return option->get_positional(); });
}

/// "--threads", or both of "-h" and "--help".
std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back('-' + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

bool takes_value(const CLI::Option& option) {
  return option.get_items_expected_max() > 0;
}

/// The words that stand for a value, as the help has them: "WHEN:{always,auto}". None where any text will do.
std::vector<std::string> choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t begin = type.find('{'), end = type.find('}');
  if (begin == std::string::npos || end == std::string::npos) return {};
  return words_of(type.substr(begin + 1, end - begin - 1));
}

/// "WHEN" of "WHEN:{always,auto}".
std::string value_name(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  return type.substr(0, type.find(':'));
}

bool takes_list(const CLI::Option& option) {
  return value_name(option).find(',') != std::string::npos && !choices_of(option).empty();
}

bool takes_file(const CLI::Option& option) {
  return value_name(option) == "FILE" || value_name(option) == "SCENARIO.json";
}

bool takes_folder(const CLI::Option& option) {
  return value_name(option) == "DIR";
}

std::string joined(const std::vector<std::string>& words, const char* between = " ") {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

/// The text with a backslash before each of some characters.
std::string escaped(const std::string& text, const std::string& characters) {
  std::string result;
  for (const char character : text) {
    if (characters.find(character) != std::string::npos) result.push_back('\\');
    result.push_back(character);
  }
  return result;
}

std::string option_words(const CLI::App& command) {
  std::vector<std::string> words;
  for (const CLI::Option* option : options_of(command)) {
    for (const std::string& name : names_of(*option)) words.push_back(name);
  }
  return joined(words);
}

// bash --------------------------------------------------------------------------------------------------------------

/// What may stand behind an option, as lines of `case "$command $before"`.
std::string bash_values(const CLI::App& command) {
  std::string text;
  for (const CLI::Option* option : options_of(command)) {
    if (!takes_value(*option)) continue;
    std::string pattern;
    for (const std::string& name : names_of(*option)) {
      pattern += (pattern.empty() ? "\"" : " | \"") + command.get_name() + ' ' + name + '"';
    }
    const std::string choices = joined(choices_of(*option));
    text += "    " + pattern + ") ";
    if (takes_folder(*option)) {
      text += "compopt -o dirnames; ";
    } else if (takes_list(*option)) {
      text += "_dcem_list \"" + choices + "\"; ";
    } else if (!choices.empty()) {
      text += "COMPREPLY=($(compgen -W \"" + choices + "\" -- \"$word\")); ";
    } else if (!takes_file(*option)) {  // without an answer bash offers files
      text += "compopt +o default; ";
    }
    text += "return ;;\n";
  }
  return text;
}

std::string bash_script(const CLI::App& app) {
  std::string values, options;
  std::vector<std::string> commands;
  for (const CLI::App* command : commands_of(app)) {
    commands.push_back(command->get_name());
    values += bash_values(*command);
    const std::vector<const CLI::Option*> positionals = positionals_of(*command);
    const std::string first = positionals.empty() ? "" : joined(choices_of(*positionals.front()));
    options += "    " + command->get_name() + ") options=\"" + option_words(*command) + '"';
    if (!first.empty()) options += "; ((COMP_CWORD == 2)) && words=\"" + first + '"';
    options += " ;;\n";
  }
  return "# Completion of dcem for bash, made by 'dcem completion bash'.\n"
         "_dcem_list() {  # words divided by commas: the last one is completed\n"
         "  local done=\n"
         "  [[ $word == *,* ]] && done=${word%,*},\n"
         "  compopt -o nospace\n"
         "  COMPREPLY=($(compgen -P \"$done\" -W \"$1\" -- \"${word##*,}\"))\n"
         "}\n"
         "_dcem() {\n"
         "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command= options= words=\n"
         "  COMPREPLY=()\n"
         "  ((COMP_CWORD > 1)) && command=${COMP_WORDS[1]}\n"
         "  case \"$command $before\" in\n" +
         values +
         "  esac\n"
         "  case $command in\n"
         "    \"\") options=\"" +
         option_words(app) + "\" words=\"" + joined(commands) + "\" ;;\n" + options +
         "  esac\n"
         "  [[ $word == -* ]] && words=$options\n"
         "  [[ $command == \"\" || -n $words ]] && compopt +o default\n"
         "  COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n"
         "}\n"
         "complete -o default -F _dcem dcem\n";
}

// zsh ---------------------------------------------------------------------------------------------------------------

std::string zsh_action(const CLI::Option& option) {
  const std::string choices = joined(choices_of(option));
  if (takes_folder(option)) return "_files -/";
  if (takes_list(option)) return "_values -s , key " + choices;
  if (!choices.empty()) return '(' + choices + ')';
  return option.get_positional() || takes_file(option) ? "_files" : "";
}

/// A text between single quotes.
std::string zsh_quoted(const std::string& text) {
  std::string result;
  for (const char character : text) result += character == '\'' ? std::string("'\\''") : std::string(1, character);
  return '\'' + result + '\'';
}

std::string zsh_arguments(const CLI::App& command) {
  std::string text = "_arguments";
  for (const CLI::Option* option : options_of(command)) {
    for (const std::string& name : names_of(*option)) {
      std::string spec = name + '[' + escaped(option->get_description(), "[]:\\") + ']';
      if (takes_value(*option)) spec += ':' + escaped(value_name(*option), ":\\") + ':' + zsh_action(*option);
      text += " \\\n        " + zsh_quoted(spec);
    }
  }
  for (const CLI::Option* option : positionals_of(command)) {
    text += " \\\n        " + zsh_quoted(':' + value_name(*option) + ':' + zsh_action(*option));
  }
  return text;
}

std::string zsh_script(const CLI::App& app) {
  std::string names, cases;
  for (const CLI::App* command : commands_of(app)) {
    names += "    " + zsh_quoted(command->get_name() + ':' + escaped(command->get_description(), ":\\")) + '\n';
    cases += "      " + command->get_name() + ")\n        " + zsh_arguments(*command) + " ;;\n";
  }
  std::string own;
  for (const CLI::Option* option : options_of(app)) {
    for (const std::string& name : names_of(*option)) {
      own += ' ' + zsh_quoted(name + '[' + escaped(option->get_description(), "[]:\\") + ']');
    }
  }
  return "#compdef dcem\n"
         "# Completion of dcem for zsh, made by 'dcem completion zsh'.\n"
         "_dcem() {\n"
         "  local state line\n"
         "  local -a commands=(\n" +
         names +
         "  )\n"
         "  _arguments -C" +
         own +
         " '1: :->command' '*:: :->arguments'\n"
         "  case $state in\n"
         "    command) _describe command commands ;;\n"
         "    arguments) case $words[1] in\n" +
         cases +
         "    esac ;;\n"
         "  esac\n"
         "}\n"
         "if [ \"$funcstack[1]\" = _dcem ]; then _dcem \"$@\"; else compdef _dcem dcem; fi\n";
}

// fish --------------------------------------------------------------------------------------------------------------

std::string fish_quoted(const std::string& text) {
  return '\'' + escaped(text, "'\\") + '\'';
}

std::string fish_options(const CLI::App& command, const std::string& condition) {
  std::string text;
  for (const CLI::Option* option : options_of(command)) {
    text += "complete -c dcem -n " + fish_quoted(condition);
    for (const std::string& name : option->get_snames()) text += " -s " + name;
    for (const std::string& name : option->get_lnames()) text += " -l " + name;
    const std::vector<std::string> choices = choices_of(*option);
    if (takes_folder(*option)) {
      text += " -x -a '(__fish_complete_directories)'";
    } else if (takes_list(*option)) {
      text += " -x -a '(__fish_complete_list , \"printf %s\\\\\\\\n " + joined(choices) + "\")'";
    } else if (takes_file(*option)) {
      text += " -r -F";
    } else if (takes_value(*option)) {
      text += " -x";
      if (!choices.empty()) text += " -a " + fish_quoted(joined(choices));
    }
    text += " -d " + fish_quoted(option->get_description()) + '\n';
  }
  return text;
}

std::string fish_script(const CLI::App& app) {
  std::string text = "# Completion of dcem for fish, made by 'dcem completion fish'.\ncomplete -c dcem -e\n";
  text += fish_options(app, "__fish_use_subcommand");
  for (const CLI::App* command : commands_of(app)) {
    text += "complete -c dcem -f -n __fish_use_subcommand -a " + command->get_name() + " -d " +
            fish_quoted(command->get_description()) + '\n';
  }
  for (const CLI::App* command : commands_of(app)) {
    const std::string condition = "__fish_seen_subcommand_from " + command->get_name();
    text += fish_options(*command, condition);
    for (const CLI::Option* option : positionals_of(*command)) {
      const std::vector<std::string> choices = choices_of(*option);
      if (choices.empty()) continue;
      text += "complete -c dcem -f -n " + fish_quoted(condition) + " -a " + fish_quoted(joined(choices)) + '\n';
    }
  }
  return text;
}

}  // namespace

std::string completion_script(const CLI::App& app, const std::string& shell) {
  if (shell == "bash") return bash_script(app);
  if (shell == "zsh") return zsh_script(app);
  if (shell == "fish") return fish_script(app);
  throw UsageError("'" + shell + "': no completion for this shell", "bash, zsh or fish");
}

}  // namespace dcem::program
