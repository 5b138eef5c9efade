// Scripts that complete the program's command line in shells, made from the tree of its options.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace claray::cli {

[[nodiscard]] std::string bash_completion(const CLI::App& app);
[[nodiscard]] std::string zsh_completion(const CLI::App& app);
[[nodiscard]] std::string fish_completion(const CLI::App& app);

}  // namespace claray::cli
