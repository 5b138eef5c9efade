// A render in a file: JSON whose keys are the options of `claray render`, made from the tree of its options.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace claray::cli {

/// --print-job and --job-schema. The latter ends the program's work while the command line is parsed.
struct JobOptions {
    bool print = false;
};
void add_job_options(CLI::App& command, JobOptions& options);

/// What a command line that is parsed chose, as the text of a job; paths are those of the command line.
[[nodiscard]] std::string job_text(const CLI::App& command);

/// If `arguments`, those behind the program's name, render a job: arguments that render the same without its file.
/// Options of the command line take precedence; paths in the job begin at its folder. Throws ErrorKind::usage, naming
/// the file and the key, for a key that is no option and a value of another type; ErrorKind::user for a file that
/// cannot be read or is no JSON.
[[nodiscard]] std::vector<std::string> without_job(const std::vector<std::string>& arguments);

}  // namespace claray::cli
