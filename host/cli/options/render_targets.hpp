// Choosing by target on the command line of `claray render`.
#pragma once

#include <CLI/CLI.hpp>

#include "claray/target.hpp"
#include "host/cli/options/render_options.hpp"

namespace claray::cli {

void add_target_options(CLI::App& command, RenderOptions& options);
/// Throws ErrorKind::usage where options contradict each other; sets what follows from them.
void check_targets(const CLI::App& command, RenderOptions& options);

/// Says on standard error what is measured, where not quiet; a signal ends it.
[[nodiscard]] MeasuringProgress measuring_progress(bool quiet);
/// What was picked and why.
void print_picks(const TargetPlan& plan);
/// claray render --fps. Throws ErrorKind::user where the rate was not held.
void run_frames(const Device& device, const Scene& scene, const RenderOptions& options);
/// Throws ErrorKind::user, saying what would be needed, where a render ended before it had the error asked for.
void refuse_missed_error(const RenderConfig& config, const RenderProgress& reached);

}  // namespace claray::cli
