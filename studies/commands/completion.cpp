#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "studies/case/json_text.h"
#include "studies/commands/arguments.h"
#include "studies/commands/command.h"
#include "studies/commands/command_description.h"
#include "studies/commands/completion_scripts.h"

namespace gladstone::inline commands {

CommandBody attach_completion(CLI::App& app, GlobalOptions const& options) {
  app.footer(app.get_footer() +
             "\n\nThe Debian package installs the scripts and the manual page. Otherwise:\n\n"
             "  gladstone completion bash > ~/.local/share/bash-completion/completions/gladstone\n"
             "  gladstone completion zsh > DIR/_gladstone      # DIR: a folder of $fpath\n"
             "  gladstone completion fish > ~/.config/fish/completions/gladstone.fish\n"
             "  gladstone completion man > gladstone.1 && man ./gladstone.1");
  auto kind = std::make_shared<std::string>();
  app.add_option("kind", *kind, "Shell whose completion script is printed, or man for the manual page")
      ->required()
      ->check(one_of({"bash", "zsh", "fish", "man"}));
  return [kind, &app, &options] {
    CommandDescription const program = describe_command(*app.get_parent(), "");
    std::string const text = *kind == "bash"   ? bash_completion(program)
                             : *kind == "zsh"  ? zsh_completion(program)
                             : *kind == "fish" ? fish_completion(program)
                                               : manual_page(program);
    print_result(options, json_text(nlohmann::ordered_json{{"kind", *kind}, {"text", text}}), text);
    return ok;
  };
}

}  // namespace gladstone::inline commands
