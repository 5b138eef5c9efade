// Targets on the command line of `claray render`: --error, --time and --fps.
#pragma once

#include <CLI/CLI.hpp>

#include "claray/plan/target.hpp"
#include "host/cli/options/render_options.hpp"

namespace claray::cli {

void add_target_options(CLI::App& command, RenderOptions& options);
/// Throws ErrorKind::usage if options contradict each other. Sets the options that follow from others.
void check_targets(const CLI::App& command, RenderOptions& options);

/// Unless quiet, prints on standard error what is measured. A signal ends the measurement.
[[nodiscard]] MeasuringProgress measuring_progress(bool quiet);
/// Prints what was picked and why.
void print_picks(const std::vector<std::string>& picks);
/// claray render --fps. Throws ErrorKind::user if the rate was not reached.
void run_frames(const Device& device, const Scene& scene, const RenderOptions& options);
/// Throws ErrorKind::user if a render ended before it reached its error. The message names the samples it needs.
void refuse_missed_error(const RenderConfig& config, const RenderProgress& reached);

}  // namespace claray::cli
